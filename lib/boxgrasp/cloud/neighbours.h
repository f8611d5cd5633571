// Distances from points to their nearest neighbours. Internal to this room.
#pragma once

#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// Of each point: the mean distance to its k nearest neighbours, and the distance to the nearest.
struct NeighbourDistances {
  std::vector<double> mean, nearest;
};

// Neighbours are looked for within `radius_m`, and for points that have fewer there within a radius that
// doubles; so it should hold about 2k points. Pre: 1 <= k < cloud.size(), radius_m > 0.
// The result does not depend on the number of threads (0 = all cores).
NeighbourDistances neighbourDistances(const PointCloud& cloud, int k, double radius_m, int threads,
                                      const StopToken& stop);

}  // namespace boxgrasp
