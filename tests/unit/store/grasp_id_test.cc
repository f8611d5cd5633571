#include "boxgrasp/store/grasp_id.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "boxgrasp/base/random.h"
#include "error_of.h"

namespace boxgrasp {
namespace {

using ::testing::HasSubstr;

TEST(GraspId, ReadsLikeAName) {
  EXPECT_EQ(formatGraspId({{"mug", 1.0, "whole"}, GraspSource::planner, 17}), "mug@1.00/whole/planner/17");
  EXPECT_EQ(formatGraspId({{"a/b@c", 0.125, "front"}, GraspSource::random, 0}), "a/b@c@0.125/front/random/0");
}

TEST(GraspId, ParsingInvertsFormatting) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 1000; ++i) {
    const double scale = std::exp(20 * normal(random));
    const GraspId id{{"o@2/x", scale, "v"}, static_cast<GraspSource>(i % 3), i};
    EXPECT_EQ(parseGraspId(formatGraspId(id)), id) << formatGraspId(id);
    EXPECT_EQ(parseModelKey(formatModelKey(id.model)), id.model);
  }
}

TEST(GraspId, RefusesEverythingElse) {
  for (const char* text :
       {"", "/", "mug", "mug@1.00/whole/planner", "mug@1.00/whole/planner/x", "mug@1.00/whole/planner/-1",
        "mug@1.00/whole/guess/1", "mug@-1/whole/planner/1", "mug@inf/whole/planner/1", "mug/whole/planner/1",
        "@1/whole/planner/1", "mug@1.0x/whole/planner/1", "mug@1//planner/1",
        "mug@1/whole/planner/99999999999"}) {
    EXPECT_THAT(test::errorOf([&] { parseGraspId(text); }), HasSubstr("mug@1.00/whole/planner/17")) << text;
  }
}

}  // namespace
}  // namespace boxgrasp
