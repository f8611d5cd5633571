// Everything that happens on one face: from its image to grasps that are clear of collisions (paper III).
#pragma once

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/point_grid.h"
#include "boxgrasp/planning/plan.h"
#include "boxgrasp/planning/tally.h"

namespace boxgrasp {

// What the faces of one object have in common. References outlive the calls.
struct FaceWork {
  const HandDescription& hand;
  const PlannerOptions& options;  // with the request's friction in every stage
  const PlannedObject& object;
  int object_index;
  const PointGrid& object_grid_C;  // the object's own points: where contacts are
  const PointGrid& scene_grid_C;   // all points: what the hand may meet
  const Viewpoints& viewpoints_C;  // where sensors stood
  const Robot& robot;
  const std::optional<Vector3d>& gravity_C;  // unit
  const StopToken& stop;
};

// The unranked grasps (score NaN) on a graspable face, in a fixed order. Fills the trace where one is given.
std::vector<Grasp> graspsOnFace(const FaceWork& work, const Face& face, Tally& tally, FaceTrace* trace);

}  // namespace boxgrasp
