// A cloud's surface as evenly spread points, nearly the same for clouds of the same shape.
#pragma once

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// The largest extent of the cloud along the three axes (columns), without the outermost fiftieth of the
// points at each end: a few outliers do not change it. Pre: not empty.
double trimmedSize(const PointCloud& cloud_C, const Matrix3d& axes_C);

// Moves the mean of each voxel's points uphill in the cloud's density, smoothed by a Gaussian of deviation
// `resolution_m` (mean shift), where it has seen the noise of that size average out; then keeps one point a
// voxel, so that all parts of the surface count alike, however densely they were seen. Details smaller than
// the resolution go, and so do strays, around which the cloud is thin. The voxels' edges are along the axes
// (columns). Pre: not empty, finite.
PointCloud evenSurface(const PointCloud& cloud_C, double resolution_m, const Matrix3d& axes_C,
                       const StopToken& stop);

}  // namespace boxgrasp
