// The planner: from a cloud to ranked grasps, in the order of the paper's sections.
#pragma once

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/planning/plan.h"

namespace boxgrasp {

// Plans with one hand, one model and one set of options; immutable, so one planner serves all threads.
class GraspPlanner {
 public:
  GraspPlanner(HandDescription hand, Model model, PlannerOptions options = {});

  // Never throws for bad input, deadline or cancellation: these are outcomes.
  PlanResult plan(PlanRequest request, const StopToken& stop = {}, PlanTrace* trace = nullptr) const;

  const HandDescription& hand() const { return hand_; }
  const Model& model() const { return model_; }
  const PlannerOptions& options() const { return options_; }

 private:
  HandDescription hand_;
  Model model_;
  PlannerOptions options_;
};

}  // namespace boxgrasp
