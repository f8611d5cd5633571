// A frame that moves with the cloud: what is computed in it does not depend on how the cloud was posed.
#pragma once

#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// The pose X_CK of the canonical frame K of a cloud: origin at the mean, axes along the principal axes in
// order of falling variance, the first two signed so that the third central moment along them is positive,
// the third by right-handedness. Sums are exact integers (moments rounded to 2^-21 of their largest), so the
// order of the points does not matter at all. Pre: the cloud is finite and not empty.
Pose canonicalFrame(const PointCloud& cloud_C);

// The same, where the cloud's bounds are known.
Pose canonicalFrame(const PointCloud& cloud_C, const Eigen::AlignedBox3d& bounds_C);

}  // namespace boxgrasp
