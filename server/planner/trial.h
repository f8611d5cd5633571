// The first plans of a new model: does it do harm?
#pragma once

#include <string>

#include "boxgrasp/plan_response_t.hpp"

namespace boxgrasp {

// Watches plans that ranked grasps. A model fails at once when it scores a grasp whose measures are finite
// with something that is not; and after kPlans plans when these took together more than kMostSlowdown times
// what they would have taken with the model before: the same plans, so that it does not matter which clouds
// came.
class Trial {
 public:
  static constexpr int kPlans = 20;
  static constexpr double kMostSlowdown = 1.5;

  // old_grasp_s: what the model before takes to score a grasp, seconds.
  Trial(std::string version, double old_grasp_s) : version_(std::move(version)), old_grasp_s_(old_grasp_s) {}

  // Plans of other models are ignored.
  void add(const plan_response_t& plan);

  const std::string& version() const { return version_; }
  bool failed() const { return !failure_.empty(); }
  const std::string& failure() const { return failure_; }
  bool passed() const { return !failed() && plans_ >= kPlans; }

 private:
  std::string version_;
  double old_grasp_s_;
  int plans_ = 0;
  double time_s_ = 0.0, time_before_s_ = 0.0;  // of all plans: as measured; as with the model before
  std::string failure_;
};

}  // namespace boxgrasp
