// Convex hulls in the six dimensions of wrenches.
#pragma once

#include <vector>

#include "boxgrasp/wrench/grasp_wrench_space.h"

namespace boxgrasp {

struct WrenchHull {
  double inradius =
      0.0;  // signed distance from the origin to the nearest facet's plane; <= 0: not strictly inside
  double volume = 0.0;  // 0, as the distance, where the points span fewer than six dimensions
};

// The hull of the points, within rounding. Coincident points, and points on facets or inside, are welcome.
WrenchHull wrenchHull(std::vector<Wrench> points);

}  // namespace boxgrasp
