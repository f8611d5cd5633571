// The outermost points of a cloud. Part of minVolumeBox.
#pragma once

#include <vector>

#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// Appends to `found` the points of the cloud that are lowest and highest along each of the three directions
// (columns), measured from `origin` in single precision. Of equal points the one with the smallest
// coordinates is taken, so the order of the cloud does not matter. Pre: the cloud is not empty.
void appendSupportPoints(const PointCloud& cloud, const Vector3d& origin, const Matrix3d& directions,
                         PointCloud& found);

}  // namespace boxgrasp
