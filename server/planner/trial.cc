#include "trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace boxgrasp {
namespace {

bool isRuined(const grasp_t& grasp) {
  return !std::isfinite(grasp.score) && std::all_of(std::begin(grasp.quality), std::end(grasp.quality),
                                                    [](double q) { return std::isfinite(q); });
}

}  // namespace

void Trial::add(const plan_response_t& plan) {
  const auto ranking = std::find_if(plan.stages.begin(), plan.stages.end(),
                                    [](const stage_t& stage) { return stage.name == "ranking"; });
  if (plan.model_version != version_ || ranking == plan.stages.end()) return;
  ++plans_;
  time_s_ += plan.time_s;
  time_before_s_ += plan.time_s - ranking->time_s + static_cast<double>(ranking->num_in) * old_grasp_s_;
  if (std::any_of(plan.grasps.begin(), plan.grasps.end(), isRuined))
    failure_ = fmt::format("it scored a grasp of request '{}' with no finite number", plan.request_id);
  else if (plans_ == kPlans && time_s_ > kMostSlowdown * time_before_s_)
    failure_ =
        fmt::format("{} plans took {:.2f} times as long as with the model before; at most {} are allowed",
                    plans_, time_s_ / time_before_s_, kMostSlowdown);
}

}  // namespace boxgrasp
