// All grasps of one object: to which of its faces a hand may come, and what is tried where none has a grasp.
#pragma once

#include <string>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/point_grid.h"
#include "boxgrasp/planning/plan.h"
#include "boxgrasp/planning/tally.h"

namespace boxgrasp {

// What the objects of a scene have in common. References outlive the calls.
struct ObjectWork {
  const HandDescription& hand;
  const PlannerOptions& options;  // with the request's friction in every stage
  const PointGrid& scene_grid_C;  // all points: what the hand may meet
  const Surroundings& surroundings;
  const Robot& robot;
  const StopToken& stop;
};

struct ObjectGrasps {
  std::vector<Grasp> grasps;  // unranked (score NaN), in a fixed order
  std::vector<FaceTrace> traces;
  Tally tally;
  std::string note;  // for users, where the grasps are not what was asked for at first
};

// `index`: of the object in its scene. Where no grasp is found, more is allowed in turn, as the options say:
// approaches over edges; faces that no sensor saw, where they were guessed; contacts that are not in force
// closure. Tally
// and traces are those of the search that found grasps, else of the first. Traces hold images only if
// `traced`.
ObjectGrasps graspsOnObject(const ObjectWork& work, const PlannedObject& object, int index, bool traced);

}  // namespace boxgrasp
