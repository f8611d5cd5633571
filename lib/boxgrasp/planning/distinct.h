// Keeping different grasps only.
#pragma once

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/planning/plan.h"

namespace boxgrasp {

// Whether two grasps are one to a robot: palms and contacts all nearer than `distance_m`, palms turned by
// less than `angle_rad`. Fingers F1 and F2 may be exchanged.
bool nearlyIdentical(const Grasp& a, const Grasp& b, double distance_m, double angle_rad);

// The best-first list without those that are nearly identical to a better one; at most top_k (0 = all).
std::vector<Grasp> distinctGrasps(std::vector<Grasp> ranked, int top_k, double distance_m, double angle_rad,
                                  const StopToken& stop);

}  // namespace boxgrasp
