#include "boxgrasp/synthesis/regions.h"

#include <gmock/gmock.h>

#include "boxgrasp/base/error.h"
#include "boxgrasp/geometry/polygon.h"
#include "drawings.h"

namespace boxgrasp {
namespace {

using test::Blob;
using test::circleContour;
using test::kPixel_m;
using test::reversed;
using test::squareContour;

Contour rotatedStart(Contour contour, std::size_t by) {
  std::rotate(contour.points_F.begin(), contour.points_F.begin() + static_cast<std::ptrdiff_t>(by),
              contour.points_F.end());
  return contour;
}

std::size_t nearestPoint(const Contour& contour, const Vector2d& p) {
  std::size_t best = 0;
  for (std::size_t i = 0; i < contour.points_F.size(); ++i) {
    if ((contour.points_F[i] - p).norm() < (contour.points_F[best] - p).norm()) best = i;
  }
  return best;
}

// The stretch of contour under a region, from its end points.
struct Stretch {
  double length = 0.0, sum = 0.0, absolute = 0.0, most = 0.0;
  std::size_t first = 0, last = 0;
};
Stretch under(const Contour& contour, const std::vector<double>& kappa, const Region& region) {
  Stretch stretch;
  const std::size_t n = contour.points_F.size();
  stretch.first = nearestPoint(contour, region.a_F);
  stretch.last = nearestPoint(contour, region.b_F);
  for (std::size_t i = stretch.first;; i = (i + 1) % n) {
    stretch.sum += kappa[i];
    stretch.absolute += std::abs(kappa[i]);
    stretch.most = std::max(stretch.most, std::abs(kappa[i]));
    if (i == stretch.last) break;
    stretch.length += (contour.points_F[(i + 1) % n] - contour.points_F[i]).norm();
  }
  return stretch;
}

// The same chords up to `tolerance_m`, in either sense.
bool sameChord(const Region& p, const Region& q, double tolerance_m) {
  const auto near = [&](const Vector2d& a, const Vector2d& b) { return (a - b).norm() <= tolerance_m; };
  return (near(p.a_F, q.a_F) && near(p.b_F, q.b_F)) || (near(p.a_F, q.b_F) && near(p.b_F, q.a_F));
}
void expectSameRegions(const std::vector<Region>& some, const std::vector<Region>& others,
                       double tolerance_m) {
  EXPECT_EQ(some.size(), others.size());
  for (const auto& p : some) {
    EXPECT_TRUE(std::any_of(others.begin(), others.end(),
                            [&](const auto& q) { return sameChord(p, q, tolerance_m); }))
        << "no counterpart of the region from " << p.a_F.transpose() << " to " << p.b_F.transpose();
  }
}

TEST(Curvature, OfACircleIsKOverRadius) {
  for (const double radius_m : {0.02, 0.05, 0.15}) {
    const Contour circle = circleContour(radius_m);
    for (const int k : {3, 5, 8}) {
      const RegionOptions options{.k = k};
      const double expected =
          2 * std::asin(k * kPixel_m / (2 * radius_m));  // the inscribed angle, about k / R
      for (const double kappa : curvature(circle, options)) EXPECT_NEAR(kappa, expected, 0.02 * expected);
      for (const double kappa : curvature(reversed(circle), options)) {
        EXPECT_NEAR(kappa, -expected, 0.02 * expected) << "a hole is concave";
      }
    }
  }
}

TEST(Curvature, OfALineIsZeroAndOfACornerAboveTheBound) {
  Contour line;
  for (int i = 0; i < 40; ++i) line.points_F.emplace_back(0.0007 * i, 0.0007 * i);
  for (const double kappa : curvature(line)) EXPECT_NEAR(kappa, 0.0, 1e-12);

  const Contour square = squareContour(0.1);
  const auto kappa = curvature(square);
  for (const Vector2d& corner : {Vector2d(-0.05, -0.05), Vector2d(0.05, -0.05), Vector2d(0.05, 0.05)}) {
    EXPECT_GT(kappa[nearestPoint(square, corner)], RegionOptions{}.max_curvature_rad);
  }
  EXPECT_NEAR(kappa[nearestPoint(square, {0.0, -0.05})], 0.0, 1e-9);
}

TEST(Curvature, SumsToKTurnsAroundAnyClosedContour) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 10; ++trial) {
    const Contour contour = Blob(0.06, 0.06, random).contour();
    double sum = 0.0;
    for (const double kappa : curvature(contour)) sum += kappa;
    EXPECT_NEAR(sum, 2 * std::numbers::pi * RegionOptions{}.k, 0.02 * 30) << "smoothing keeps the sum";
  }
}

TEST(Curvature, OfAnOpenContourRepeatsItsLastValueAtTheEnds) {
  const Contour circle = circleContour(0.05);
  Contour arc;
  arc.points_F.assign(circle.points_F.begin(), circle.points_F.begin() + 60);
  for (const double kappa : curvature(arc)) EXPECT_NEAR(kappa, 0.1, 0.002);
}

TEST(Curvature, OfTooFewPointsIsZero) {
  for (std::size_t n = 0; n < 3; ++n) {
    Contour contour;
    contour.points_F.assign(n, Vector2d(0.01, 0.02));
    EXPECT_EQ(curvature(contour), std::vector<double>(n, 0.0));
    EXPECT_TRUE(findRegions({contour}).empty());
  }
}

TEST(Regions, SatisfyTheFourConditionsOnRandomShapes) {
  std::mt19937_64 random(2);
  std::size_t regions_seen = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Contour contour = Blob(uniform(random, 0.03, 0.1), 0.12, random).contour();
    for (const auto sum : {CurvatureSum::with_sign, CurvatureSum::absolute}) {
      const RegionOptions options{.sum = sum};
      const auto kappa = curvature(contour, options);
      for (const Region& region : findRegions({contour}, options)) {
        const Stretch stretch = under(contour, kappa, region);
        EXPECT_LE(stretch.most, 0.4 + 1e-12);
        EXPECT_LE(sum == CurvatureSum::absolute ? stretch.absolute : std::abs(stretch.sum), 4.0 + 1e-12);
        EXPECT_GE(stretch.length, 0.020 - 1e-12);
        EXPECT_LE(stretch.length, 0.050 + 1e-12);
        ++regions_seen;
      }
    }
  }
  EXPECT_GT(regions_seen, 500u);
}

TEST(Regions, DoNotOverlapAndTheirNormalsPointIntoTheMaterial) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Blob blob(0.06, 0.08, random);
    const Contour contour = blob.contour();
    const auto kappa = curvature(contour);
    double total = 0.0;
    for (const Region& region : findRegions({contour})) {
      total += under(contour, kappa, region).length;
      EXPECT_NEAR(region.normal_F.norm(), 1.0, 1e-12);
      EXPECT_NEAR(region.normal_F.dot(region.b_F - region.a_F), 0.0, 1e-12);
      EXPECT_GT(cross(region.b_F - region.a_F, region.normal_F), 0.0) << "the normal is on the left";
      EXPECT_TRUE(blob.contains(0.5 * (region.a_F + region.b_F) + 0.008 * region.normal_F));
    }
    EXPECT_LE(total, test::lengthOf(contour) + 1e-9);
  }
}

TEST(Regions, DoNotDependOnTheContoursDirectionOrStart) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 30; ++trial) {
    // A small roughness leaves shapes of low curvature all around: these start at a point of their own.
    const Contour contour = Blob(0.06, trial % 2 ? 0.1 : 0.01, random).contour();
    const auto regions = findRegions({contour});
    EXPECT_FALSE(regions.empty());
    const auto turned = findRegions({rotatedStart(contour, uniformIndex(random, contour.points_F.size()))});
    expectSameRegions(regions, turned, 1e-9);
    const auto back = findRegions({reversed(contour)});
    expectSameRegions(regions, back, 1.5 * kPixel_m);
  }
}

TEST(Regions, ASquareOf100MillimetresHasTwoOnEachSide) {
  const auto regions = findRegions({squareContour(0.1)});
  ASSERT_EQ(regions.size(), 8u);
  for (const Vector2d& normal : {Vector2d(0, 1), Vector2d(-1, 0), Vector2d(0, -1), Vector2d(1, 0)}) {
    EXPECT_EQ(std::count_if(regions.begin(), regions.end(),
                            [&](const auto& r) { return r.normal_F.dot(normal) > 0.999; }),
              2);
  }
  for (const auto& region : regions)
    EXPECT_NEAR(region.length(), regions[0].length(), 2 * kPixel_m) << "broken evenly";
}

TEST(Regions, ACircleIsBrokenIntoAsFewAsItsBendingAllows) {
  for (const double radius : {0.03, 0.05, 0.1}) {
    const auto regions = findRegions({circleContour(radius)});
    // k turns in all, T_kappa each; or the circumference in pieces of l_max.
    const double fewest = std::max(5 * 2 * std::numbers::pi / 4.0, 2 * std::numbers::pi * radius / 0.05);
    EXPECT_GE(regions.size(), static_cast<std::size_t>(std::ceil(fewest)));
    EXPECT_LE(regions.size(), static_cast<std::size_t>(std::ceil(fewest)) + 1);
  }
  EXPECT_TRUE(findRegions({circleContour(0.010)}).empty()) << "bent more than t_kappa";
}

TEST(Regions, AreShortWhereTheContourBendsAndLongWhereItIsFlat) {
  std::vector<Vector2d> ellipse;
  for (int i = 0; i < 3000; ++i) {
    const double angle = 2 * std::numbers::pi * i / 3000;
    ellipse.emplace_back(0.12 * std::cos(angle), 0.06 * std::sin(angle));
  }
  for (const Region& region : findRegions({test::closedContour(ellipse)})) {
    const Vector2d middle = 0.5 * (region.a_F + region.b_F);
    if (std::abs(middle.x()) < 0.03) {
      EXPECT_GT(region.length(), 0.040) << "flank";
    }
    if (std::abs(middle.x()) > 0.108) {
      EXPECT_LT(region.length(), 0.032) << "tip";
    }
  }
}

TEST(Regions, AStraightLineIsBrokenEvenly) {
  Contour line;
  for (int i = 0; i <= 120; ++i) line.points_F.emplace_back(0.001 * i, 0.0);
  const auto regions = findRegions({line});
  ASSERT_EQ(regions.size(), 3u);
  for (const auto& region : regions) EXPECT_NEAR(region.length(), 0.040, 0.0011);
  line.points_F.resize(20);
  EXPECT_TRUE(findRegions({line}).empty()) << "19 mm are too short for a finger";
}

TEST(Regions, WavesBreakARegionOnlyWhenTheSumIsAbsolute) {
  Contour wave;
  for (int i = 0; i <= 45; ++i) wave.points_F.emplace_back(0.001 * i, 0.0012 * std::sin(0.45 * i));
  EXPECT_EQ(findRegions({wave}, {.sum = CurvatureSum::with_sign}).size(), 1u);
  EXPECT_NE(findRegions({wave}, {.sum = CurvatureSum::absolute}).size(), 1u);
}

TEST(Regions, RememberTheirContourAndItsKind) {
  Contour inner = reversed(squareContour(0.05));
  inner.kind = ContourKind::inner;
  const auto regions = findRegions({squareContour(0.1), inner});
  ASSERT_EQ(regions.size(), 12u);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    EXPECT_EQ(regions[i].contour, i < 8 ? 0 : 1);
    EXPECT_EQ(regions[i].kind, i < 8 ? ContourKind::outer : ContourKind::inner);
    if (i >= 8) {
      EXPECT_GT(regions[i].normal_F.dot(regions[i].a_F), 0.0) << "away from the hole";
    }
  }
}

TEST(Regions, CoincidentPointsGiveNone) {
  Contour spot;
  spot.closed = true;
  spot.points_F.assign(50, Vector2d(0.01, 0.01));
  EXPECT_TRUE(findRegions({spot}).empty());
  EXPECT_TRUE(findRegions({}).empty());
}

TEST(Regions, BadOptionsAreNamed) {
  try {
    findRegions({}, {.min_length_m = 0.03, .max_length_m = 0.02});
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("regions.max_length_m"));
    EXPECT_THAT(error.what(), testing::HasSubstr("0.02"));
  }
}

// Of a disc's outline they turn with the material, of a hole's against it, by the arc over the radius.
TEST(Regions, TellHowFarTheOutlineTurnsAlongThem) {
  for (const double radius_m : {0.03, 0.06, 0.15}) {
    const Contour outline = circleContour(radius_m);
    for (const auto& [contour, sign] : {std::pair(outline, 1.0), std::pair(reversed(outline), -1.0)}) {
      const auto regions = findRegions({contour});
      ASSERT_FALSE(regions.empty());
      for (const Region& region : regions) {
        const double turn = 2 * std::asin(0.5 * region.length() / radius_m);
        EXPECT_NEAR(region.turn_rad, sign * turn, 0.08 * turn + kPixel_m / radius_m) << "radius " << radius_m;
      }
    }
  }
}

}  // namespace
}  // namespace boxgrasp
