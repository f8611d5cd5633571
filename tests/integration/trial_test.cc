// The judgement of a new model by its first plans.
#include "trial.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace boxgrasp {
namespace {

constexpr double kOld_s = 1e-6;

// A plan of 0.1 s that ranks 1000 grasps in ranking_s.
plan_response_t plan(double ranking_s, const std::string& version = "new") {
  plan_response_t response{};
  response.model_version = version;
  response.time_s = 0.1 + ranking_s;
  response.stages = {stage_t{"clean", 1, 1, 0.05}, stage_t{"ranking", 1000, 1000, ranking_s}};
  response.grasps.resize(2, grasp_t{});
  return response;
}

Trial after(int plans, const plan_response_t& each) {
  Trial trial("new", kOld_s);
  for (int i = 0; i < plans; ++i) trial.add(each);
  return trial;
}

TEST(Trial, PassesAfterItsPlans) {
  EXPECT_FALSE(after(Trial::kPlans - 1, plan(1e-3)).passed());
  EXPECT_TRUE(after(Trial::kPlans, plan(1e-3)).passed());
}

TEST(Trial, IgnoresOtherModelsAndPlansThatRankedNothing) {
  plan_response_t unranked = plan(1e-3);
  unranked.stages.pop_back();
  EXPECT_FALSE(after(2 * Trial::kPlans, unranked).passed());
  EXPECT_FALSE(after(2 * Trial::kPlans, plan(1e-3, "old")).passed());
}

// With the old model each plan would have taken 0.101 s.
TEST(Trial, FailsWhenPlansTakeTooLong) {
  const double allowed_s = Trial::kMostSlowdown * 0.101 - 0.1;
  EXPECT_TRUE(after(Trial::kPlans, plan(0.98 * allowed_s)).passed());
  const Trial slow = after(Trial::kPlans, plan(1.02 * allowed_s));
  EXPECT_TRUE(slow.failed());
  EXPECT_FALSE(slow.passed());
  EXPECT_THAT(slow.failure(), testing::HasSubstr("times as long as with the model before"));
}

TEST(Trial, FailsAtOnceOverAScoreThatIsNoNumber) {
  plan_response_t ruined = plan(1e-3);
  ruined.grasps[1].score = NAN;
  EXPECT_TRUE(after(1, ruined).failed());
  ruined.grasps[1].quality[3] = NAN;
  EXPECT_FALSE(after(1, ruined).failed()) << "a measure was none: that is not the model's fault";
}

}  // namespace
}  // namespace boxgrasp
