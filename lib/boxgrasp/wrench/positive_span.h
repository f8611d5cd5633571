// Force closure as a question of linear algebra.
#pragma once

#include <vector>

#include "boxgrasp/wrench/grasp_wrench_space.h"

namespace boxgrasp {

using WrenchMatrix = Eigen::Matrix<double, 6, Eigen::Dynamic>;  // one wrench a column

// Do the non-negative combinations of the wrenches reach all of R^6? The same as: is the origin strictly
// inside their convex hull. Answers by one feasibility problem of linear programming with six equations.
bool positivelySpan(const std::vector<Wrench>& wrenches);

}  // namespace boxgrasp
