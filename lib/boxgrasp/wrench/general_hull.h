// Convex hulls of many wrenches, by qhull.
#pragma once

#include "boxgrasp/wrench/hull.h"

namespace boxgrasp {

// The same as wrenchHull, for points that are all different and span six dimensions.
WrenchHull generalHull(std::vector<Wrench> points);

}  // namespace boxgrasp
