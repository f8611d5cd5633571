// An object's boxes and the grasps on it, as they are compared with those of other objects
// (ranking/recollections.h).
#pragma once

#include <vector>

#include "boxgrasp/planning/plan.h"
#include "boxgrasp/ranking/recollections.h"

namespace boxgrasp {

// The leaves of a tree that has at least one node.
Constellation constellationOf(const BoxTree& tree);

// One for each grasp on the object.
std::vector<GraspPlace> graspPlaces(const BoxTree& tree, const std::vector<const Grasp*>& grasps);

}  // namespace boxgrasp
