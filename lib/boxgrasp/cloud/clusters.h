// Euclidean clustering. Internal to this room.
#pragma once

#include <cstdint>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// The groups of points that are connected by steps of at most `distance_m`: indices ascending, the largest
// group first. Pre: not empty, distance_m > 0.
std::vector<std::vector<std::uint32_t>> euclideanClusters(const PointCloud& cloud, double distance_m,
                                                          const StopToken& stop);

}  // namespace boxgrasp
