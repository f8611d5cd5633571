// An order of a cloud's points in which neighbours in the order are neighbours in space.
#pragma once

#include <cstdint>
#include <vector>

#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// The indices of all points, along a Z-order curve through the cells of a grid of 32^3; those of one cell
// ascend. Only speed depends on it: runs of points are small in every projection, so most of them can be
// judged by their bounds. O(n). Pre: the cloud is finite.
std::vector<std::uint32_t> zOrder(const PointCloud& cloud);

}  // namespace boxgrasp
