#include "boxgrasp/synthesis/pinches.h"

#include <gmock/gmock.h>

#include "boxgrasp/base/error.h"
#include "drawings.h"

namespace boxgrasp {
namespace {

constexpr double kSpacing_m = 0.050;

Region regionFrom(const Vector2d& a, const Vector2d& b, int contour = 0) {
  Region region;
  region.a_F = a;
  region.b_F = b;
  const Vector2d t = (b - a).normalized();
  region.normal_F = {-t.y(), t.x()};
  region.contour = contour;
  return region;
}

// Both sides of a bar of this width along x around the origin, in pieces; the material on their left.
std::vector<Region> barSides(double width_m, int pieces, double piece_m) {
  std::vector<Region> sides;
  const double start = -0.5 * pieces * piece_m, y = 0.5 * width_m;
  for (int i = 0; i < pieces; ++i) {
    const double x = start + i * piece_m;
    sides.push_back(regionFrom({x, -y}, {x + piece_m, -y}));
    sides.push_back(regionFrom({x + piece_m, y}, {x, y}));
  }
  return sides;
}

FaceImage flatImage() {
  return test::drawnFlat(161, [](const Vector2d& p) { return p.cwiseAbs().maxCoeff() < 0.07; });
}

std::vector<Region> turned(std::vector<Region> regions, double angle, bool mirrored) {
  Eigen::Matrix2d map = Eigen::Rotation2Dd(angle).toRotationMatrix();
  if (mirrored) map.col(0) *= -1;
  for (Region& region : regions) {
    if (mirrored) std::swap(region.a_F, region.b_F);
    region.a_F = map * region.a_F;
    region.b_F = map * region.b_F;
    region.normal_F = map * region.normal_F;
  }
  return regions;
}

TEST(Pinches, HoldABarThatHasNoTriplets) {
  const auto sides = barSides(0.012, 3, 0.046);
  EXPECT_TRUE(findTriplets(sides, flatImage()).triplets.empty()) << "parallel sides do not span the plane";
  EXPECT_FALSE(findPinches(sides, flatImage(), kSpacing_m).empty());
}

TEST(Pinches, PutTheThumbMidwayBetweenFingersOneSpacingApart) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 20; ++round) {
    const double width = uniform(random, 0.005, 0.1);
    const auto regions = turned(barSides(width, 3, 0.045), uniform(random, 0, 6.28), round % 2);
    const auto pinches = findPinches(regions, flatImage(), kSpacing_m);
    ASSERT_FALSE(pinches.empty()) << "width " << width;
    for (const Triplet& pinch : pinches) {
      const auto& p = pinch.points_F;
      const Vector2d across = p[0] - p[1], ahead = 0.5 * (p[0] + p[1]) - p[2];
      EXPECT_NEAR(across.norm(), kSpacing_m, 1e-12);
      EXPECT_NEAR(across.dot(ahead), 0.0, 1e-12) << "the thumb is not midway";
      EXPECT_NEAR(ahead.dot(pinch.normals_F[2]), width, 1e-12) << "the object is not between";
      EXPECT_LT((pinch.focus_F - (p[0] + p[1] + 2 * p[2]) / 4).norm(), 1e-12);
      EXPECT_GE(pinch.focus_area_m2, 0.0);
      EXPECT_GE(pinch.nearest_depth_m[0], 0.0) << "no depth was measured";
    }
  }
}

// Of a side of twice the margin a point is left.
TEST(Pinches, PutFingersInTheMiddleOfShortSides) {
  constexpr double kLength = 1.0 / 64, kMiddle = 1.5 * kLength, kWidth = 0.02;  // exact in binary
  std::vector<Region> regions;
  regions.push_back(regionFrom({-0.06, 0}, {0.06, 0}));
  for (const double middle : {-kMiddle, kMiddle})
    regions.push_back(regionFrom({middle + 0.5 * kLength, kWidth}, {middle - 0.5 * kLength, kWidth}));
  int on_both = 0;
  for (const Triplet& pinch : findPinches(regions, flatImage(), 2 * kMiddle)) {
    for (const Vector2d& p : pinch.points_F) ASSERT_TRUE(p.allFinite());
    if (pinch.regions[2] != 0) continue;
    ++on_both;
    EXPECT_EQ(std::abs(pinch.points_F[0].x()), kMiddle);
    EXPECT_EQ(pinch.points_F[1], Vector2d(-pinch.points_F[0].x(), kWidth));
    EXPECT_NEAR(pinch.points_F[2].x(), 0.0, 1e-15) << "the thumb is midway";
  }
  EXPECT_EQ(on_both, 1) << "a finger on each of the short sides, the thumb on the long one";
}

TEST(Pinches, KeepTheMarginFromTheEndsOfASideButNotFromItsPieces) {
  const TripletOptions options;
  for (const double length : {0.072, 0.074}) {  // fingers need 50 mm and two margins of 11.5 mm: 73 mm
    const auto pinches = findPinches(barSides(0.02, 2, 0.5 * length), flatImage(), kSpacing_m, options);
    EXPECT_EQ(pinches.empty(), length < kSpacing_m + 2 * options.end_margin_m) << "length " << length;
    for (const Triplet& pinch : pinches) {
      for (const Vector2d& p : pinch.points_F)
        EXPECT_LE(std::abs(p.x()), 0.5 * length - options.end_margin_m + 1e-12);
    }
  }
}

TEST(Pinches, BothFingersMayPressOnOneSideThatIsLongEnough) {
  constexpr double kNarrow_m = 0.012;
  for (const double length : {0.033, 0.037}) {  // 12 mm and two margins of 11.5 mm: 35 mm
    const auto pinches = findPinches(barSides(0.02, 1, length), flatImage(), kNarrow_m);
    EXPECT_EQ(pinches.empty(), length < 0.035) << "length " << length;
    for (const Triplet& pinch : pinches) EXPECT_EQ(pinch.regions[0], pinch.regions[1]);
  }
}

TEST(Pinches, FingersPushAgainstTheThumbWithinTheirCones) {
  for (const double lean : {-0.5, -0.3, 0.0, 0.3, 0.5}) {  // the cone's half angle is 0.38 rad
    auto sides = barSides(0.04, 2, 0.046);
    for (Region& side : sides) {
      if (side.normal_F.y() > 0) continue;  // the thumb's
      side = regionFrom(Eigen::Rotation2Dd(lean) * side.a_F, Eigen::Rotation2Dd(lean) * side.b_F);
    }
    const bool within = std::abs(lean) < std::atan(TripletOptions{}.friction);
    EXPECT_EQ(!findPinches(sides, flatImage(), kSpacing_m).empty(), within) << "lean " << lean;
  }
}

TEST(Pinches, NothingLiesBetweenSidesThatFaceApart) {
  auto sides = barSides(0.03, 2, 0.046);
  for (Region& side : sides) side = regionFrom(side.b_F, side.a_F);  // the walls of a slot
  EXPECT_TRUE(findPinches(sides, flatImage(), kSpacing_m).empty());
}

TEST(Pinches, TheMirroredBarGivesTheMirroredPinches) {
  auto sides = barSides(0.02, 3, 0.041);
  sides.push_back(regionFrom({0.07, -0.01}, {0.12, -0.005}));
  const auto as_is = findPinches(sides, flatImage(), kSpacing_m);
  const auto mirrored = findPinches(turned(sides, 0.0, true), flatImage(), kSpacing_m);
  ASSERT_EQ(as_is.size(), mirrored.size());
  ASSERT_FALSE(as_is.empty());
  for (const Triplet& pinch : as_is) {
    const bool found = std::any_of(mirrored.begin(), mirrored.end(), [&](const Triplet& other) {
      const auto apart = [&](int mine, int its) {
        return (Vector2d(-pinch.points_F[mine].x(), pinch.points_F[mine].y()) - other.points_F[its]).norm();
      };
      return apart(0, 1) + apart(1, 0) + apart(2, 2) < 1e-9;
    });
    EXPECT_TRUE(found) << "no mirror image of the pinch at x " << pinch.points_F[2].x();
  }
}

TEST(Pinches, TheLimitAndTheStopHold) {
  const auto sides = barSides(0.02, 6, 0.03);
  EXPECT_EQ(findPinches(sides, flatImage(), kSpacing_m, {.max_triplets = 3}).size(), 3u);
  EXPECT_THROW(findPinches(sides, flatImage(), kSpacing_m, {}, StopToken(StopToken::Clock::now())), Stopped);
  EXPECT_TRUE(findPinches({}, flatImage(), kSpacing_m).empty());
}

}  // namespace
}  // namespace boxgrasp
