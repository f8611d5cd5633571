#include "boxgrasp/synthesis/round_outline.h"

#include <gtest/gtest.h>

#include "boxgrasp/synthesis/pinches.h"
#include "drawings.h"

namespace boxgrasp {
namespace {

constexpr double kRadius_m = 0.04, kSpacing_m = 0.012;
const Vector2d kCenter(0.003, -0.002);

FaceImage disc() {
  return test::drawnFlat(121, [](const Vector2d& p) { return (p - kCenter).norm() < kRadius_m; });
}

TripletOptions narrowFinger() {
  TripletOptions options;
  options.end_margin_m = 0.005;
  return options;
}

// The chords of an even polygon on the circle, the material on their left.
std::vector<Region> chords(int n, double turn) {
  std::vector<Region> regions;
  const auto corner = [&](int i) {
    return Vector2d(
        kCenter + kRadius_m * (Eigen::Rotation2Dd(turn + 2 * std::numbers::pi * i / n) * Vector2d::UnitX()));
  };
  for (int i = 0; i < n; ++i) {
    Region region;
    region.a_F = corner(i);
    region.b_F = corner(i + 1);
    const Vector2d t = (region.b_F - region.a_F).normalized();
    region.normal_F = {-t.y(), t.x()};
    regions.push_back(region);
  }
  return regions;
}

void expectOnCircle(const Triplet& triplet) {
  for (int i = 0; i < 3; ++i) {
    const Vector2d out = triplet.points_F[i] - kCenter;
    EXPECT_NEAR(out.norm(), kRadius_m, 1e-12);
    EXPECT_LT((triplet.normals_F[i] + out / kRadius_m).norm(), 1e-12)
        << "the normal is not that of the circle";
    EXPECT_GE(triplet.nearest_depth_m[i], 0.0) << "no depth was measured";
  }
}

TEST(RoundOutline, TripletsOnChordsMoveOntoTheCircleAndPushToItsCentre) {
  for (const double turn : {0.0, 0.1, 0.2}) {
    auto triplets = findTriplets(chords(9, turn), disc()).triplets;
    ASSERT_FALSE(triplets.empty());
    EXPECT_GT(snapToCircle({kCenter, kRadius_m}, disc(), {}, triplets), triplets.size() / 2);
    for (const Triplet& triplet : triplets) {
      if (triplet.focus_F != kCenter) continue;
      expectOnCircle(triplet);
      EXPECT_TRUE(positivelySpan(triplet.normals_F));
    }
  }
}

TEST(RoundOutline, PinchesMoveToOpposeEachOtherThroughTheAxisAsFarApartAsBefore) {
  auto pinches = findPinches(chords(8, 0.05), disc(), kSpacing_m, narrowFinger());
  ASSERT_FALSE(pinches.empty());
  EXPECT_EQ(snapToCircle({kCenter, kRadius_m}, disc(), {}, pinches), pinches.size());
  for (const Triplet& pinch : pinches) {
    expectOnCircle(pinch);
    const auto& p = pinch.points_F;
    EXPECT_NEAR((p[0] - p[1]).norm(), kSpacing_m, 1e-12);
    const Vector2d through = (0.5 * (p[0] + p[1]) - p[2]).normalized();
    EXPECT_LT((through - pinch.normals_F[2]).norm(), 1e-12) << "not through the axis";
    const Vector2d across(pinch.normals_F[2].y(), -pinch.normals_F[2].x());
    EXPECT_GT((p[0] - p[1]).dot(across), 0.0) << "the fingers changed sides";
  }
}

TEST(RoundOutline, WhatIsNotOnTheCircleStays) {
  auto pinches = findPinches(chords(8, 0.05), disc(), kSpacing_m, narrowFinger());
  ASSERT_FALSE(pinches.empty());
  const auto before = pinches;
  EXPECT_EQ(snapToCircle({kCenter, 0.5 * kRadius_m}, disc(), {}, pinches), 0u)
      << "the points are far outside";
  EXPECT_EQ(snapToCircle({kCenter, 2 * kRadius_m}, disc(), {}, pinches), 0u) << "the points are far inside";
  auto wide = findPinches(chords(4, 0.0), disc(), 0.045, narrowFinger());
  ASSERT_FALSE(wide.empty());
  EXPECT_EQ(snapToCircle({kCenter, kRadius_m}, disc(), {}, wide), 0u)
      << "fingers that far apart would push outside their cones";
  for (std::size_t i = 0; i < pinches.size(); ++i) EXPECT_EQ(pinches[i].points_F, before[i].points_F);
}

}  // namespace
}  // namespace boxgrasp
