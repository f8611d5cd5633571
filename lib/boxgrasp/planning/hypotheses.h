// All grasp hypotheses of a cloud, before any is preferred to another (paper II and III).
#pragma once

#include "boxgrasp/planning/plan.h"
#include "boxgrasp/planning/tally.h"

namespace boxgrasp {

// From the cloud to every hypothesis that reaches, touches, holds and is clear of collisions: result.grasps
// in a fixed order, their scores NaN, with result.objects and the notes; the tally counts the stages. On a
// stop, what was found so far is there. Move a request in
// whose cloud is not needed any more: no second one is made. Throws InputError for bad input, Stopped when
// told to stop.
void findHypotheses(const HandDescription& hand, const PlannerOptions& options, PlanRequest request,
                    const StopToken& stop, PlanTrace* trace, PlanResult& result, Tally& tally);

}  // namespace boxgrasp
