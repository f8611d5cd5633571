#include "boxgrasp/training/sights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "boxgrasp/base/error.h"
#include "boxgrasp/geometry/point_grid.h"
#include "boxgrasp/objects/parametric.h"
#include "error_of.h"

namespace boxgrasp {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

PlanRequest sight(const std::string& view, std::uint64_t seed = 1) {
  return sightOf(parametricObject("mug", 1.0), {"mug", 1.0, view},
                 {.points = 5000, .cameras = 4, .seed = seed});
}

TEST(Sights, AreNamedByTheirCameras) {
  EXPECT_EQ(wholeName(), "whole");
  EXPECT_THAT(viewNames(2), ElementsAre("view0", "view1"));
  EXPECT_THAT(pairNames(2), ElementsAre("pair0", "pair1"));
}

TEST(Sights, OfTheWholeHaveNoViewpointAndAllPoints) {
  const PlanRequest whole = sight(wholeName());
  EXPECT_EQ(whole.cloud_C.size(), 5000u);
  EXPECT_TRUE(whole.viewpoints_C.empty()) << "nobody stood anywhere: all sides are seen";
}

TEST(Sights, OfOneCameraShowTheSideThatFacesIt) {
  const PlanRequest view = sight("view0");
  ASSERT_EQ(view.viewpoints_C.size(), 1u);
  EXPECT_LT(view.viewpoints_C[0].y(), 0) << "the first camera of the ring stands on the side of -y";
  const Eigen::AlignedBox3d whole = bounds(sight(wholeName()).cloud_C);
  double sum = 0;
  for (const float y : view.cloud_C.y) sum += y - whole.center().y();
  EXPECT_LT(sum / static_cast<double>(view.cloud_C.size()), 0) << "its points lie on that side too";
}

TEST(Sights, OfAPairJoinTwoCamerasAQuarterApart) {
  const PlanRequest pair = sight("pair1"), first = sight("view1"), second = sight("view2");
  EXPECT_EQ(pair.viewpoints_C, (Viewpoints{first.viewpoints_C[0], second.viewpoints_C[0]}));
  const PointGrid grid(pair.cloud_C, 0.01);
  std::size_t near = 0;
  for (std::size_t i = 0; i < second.cloud_C.size(); ++i)
    near += grid.nearest(second.cloud_C.point(i), 0.006).has_value();
  EXPECT_GT(near, second.cloud_C.size() * 95 / 100) << "what the second camera sees is in the pair";
}

TEST(Sights, DependOnTheSeedAlone) {
  EXPECT_EQ(sight("pair0").cloud_C, sight("pair0").cloud_C);
  EXPECT_NE(sight("pair0", 1).cloud_C, sight("pair0", 2).cloud_C);
  const ModelKey key{"mug", 1.0, "view0"};
  EXPECT_NE(derivedSeed(1, key, "camera", 0), derivedSeed(1, key, "camera", 1));
  EXPECT_NE(derivedSeed(1, key, "camera", 0), derivedSeed(1, key, "push", 0));
}

TEST(Sights, OfUnknownCamerasAreRefused) {
  EXPECT_THAT(test::errorOf([] { sight("view4"); }), HasSubstr("view 'view4' is none of the 4 cameras"));
}

}  // namespace
}  // namespace boxgrasp
