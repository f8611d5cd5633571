// The plain search for the box of least volume: the oracle of the fast one. Part of minVolumeBox.
#pragma once

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// The axes of the box of least volume: for each of a few thousand directions of one edge the smallest box
// along it, exactly; then the best of them refined by turning that edge in ever smaller steps. O(n log n) a
// direction. Pre: not empty.
Matrix3d exhaustiveBoxAxes(const PointCloud& cloud_C, const StopToken& stop);

// n directions spread evenly over the half sphere z > 0 (a Fibonacci lattice).
std::vector<Vector3d> halfSphere(std::size_t n);

}  // namespace boxgrasp
