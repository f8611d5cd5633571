#include "boxgrasp/planning/tally.h"

#include <gtest/gtest.h>

#include <thread>

namespace boxgrasp {
namespace {

TEST(Tally, AddsUpInAnyGrouping) {
  Tally a, b;
  a.count(StageId::faces, 6, 2);
  b.count(StageId::faces, 12, 0);
  a.reject("blocked", 4);
  b.reject("blocked", 12);
  b.reject("nothing", 0);
  a.add(b);
  EXPECT_EQ(a[StageId::faces].in, 18u);
  EXPECT_EQ(a[StageId::faces].out, 2u);
  EXPECT_EQ(a.rejected().at("blocked"), 16u);
  EXPECT_EQ(a.rejected().count("nothing"), 0u) << "a reason that removed nothing is not listed";
}

TEST(Tally, BlamesTheFirstStageThatLetNothingThrough) {
  Tally tally;
  tally.count(StageId::scene, 1000, 1);
  tally.count(StageId::faces, 6, 3);
  tally.count(StageId::triplets, 40, 0);
  tally.count(StageId::configurations, 0, 0);
  tally.reject("triplet: friction cones do not meet", 40);
  const std::string why = whyNoGrasp(tally);
  EXPECT_NE(why.find("stage 'triplets' let none of 40"), std::string::npos) << why;
  EXPECT_NE(why.find("3 graspable faces"), std::string::npos) << why;
  EXPECT_NE(why.find("friction cones do not meet (40)"), std::string::npos) << why;
  EXPECT_NE(why.find("knobs: the friction coefficient"), std::string::npos) << why;
}

TEST(StageTimer, AddsItsLifeToTheStage) {
  Tally tally;
  {
    const StageTimer timer(tally, StageId::images);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_GE(tally[StageId::images].time_s, 0.002);
  EXPECT_EQ(tally[StageId::regions].time_s, 0.0);
}

TEST(StageText, EveryStageHasAllItsTexts) {
  for (std::size_t i = 0; i < kStageCount; ++i) {
    const StageText& text = stageText(static_cast<StageId>(i));
    EXPECT_FALSE(text.name.empty() || text.takes.empty() || text.gives.empty() || text.knob.empty())
        << "stage " << i;
  }
}

}  // namespace
}  // namespace boxgrasp
