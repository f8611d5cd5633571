#include "boxgrasp/synthesis/triplets.h"

#include <gmock/gmock.h>

#include <numeric>
#include <set>

#include "boxgrasp/base/error.h"
#include "drawings.h"

namespace boxgrasp {
namespace {

constexpr double kFriction = 0.4;

Region regionFrom(const Vector2d& a, const Vector2d& b) {
  Region region;
  region.a_F = a;
  region.b_F = b;
  const Vector2d t = (b - a).normalized();
  region.normal_F = {-t.y(), t.x()};
  return region;
}

Vector2d randomPoint(double reach, std::mt19937_64& random) {
  const double x = uniform(random, -reach, reach);
  return {x, uniform(random, -reach, reach)};
}

// Around the origin, facing it more or less.
std::vector<Region> randomRegions(int n, std::mt19937_64& random) {
  std::vector<Region> regions;
  for (int i = 0; i < n; ++i) {
    const double angle = uniform(random, 0, 2 * std::numbers::pi), turn = angle + 0.5 * normal(random);
    const Vector2d middle = uniform(random, 0.02, 0.06) * Vector2d(std::cos(angle), std::sin(angle));
    const Vector2d t(-std::sin(turn), std::cos(turn));
    const double half = 0.5 * uniform(random, 0.02, 0.05);
    regions.push_back(regionFrom(middle - half * t, middle + half * t));
  }
  return regions;
}

// Whether a finger somewhere on the region can push towards x within its cone: by the definition of a cone,
// at many points of it.
bool inSomeCone(const Region& region, const Vector2d& x, double friction, int samples = 400) {
  for (int i = 0; i <= samples; ++i) {
    const Vector2d way = x - (region.a_F + (region.b_F - region.a_F) * i / samples);
    if (way.normalized().dot(region.normal_F) >= std::cos(std::atan(friction))) return true;
  }
  return false;
}

Polygon box(double reach) { return {{-reach, -reach}, {reach, -reach}, {reach, reach}, {-reach, reach}}; }

FaceImage flatImage() {
  return test::drawnFlat(161, [](const Vector2d& p) { return p.cwiseAbs().maxCoeff() < 0.07; });
}

TEST(PositivelySpan, AgreesWithTheGapsBetweenDirections) {
  std::mt19937_64 random(1);
  int spanning = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::array<Vector2d, 3> normals;
    std::array<double, 3> angles;
    for (int i = 0; i < 3; ++i) {
      angles[i] = uniform(random, 0, 2 * std::numbers::pi);
      normals[i] = {std::cos(angles[i]), std::sin(angles[i])};
    }
    std::sort(angles.begin(), angles.end());
    const double gap = std::max(
        {angles[1] - angles[0], angles[2] - angles[1], angles[0] + 2 * std::numbers::pi - angles[2]});
    EXPECT_EQ(positivelySpan(normals), gap < std::numbers::pi) << "largest gap: " << gap;
    spanning += gap < std::numbers::pi;
  }
  EXPECT_NEAR(spanning / 2000.0, 0.25, 0.04) << "a quarter of all random triples span";
  EXPECT_FALSE(positivelySpan({Vector2d(1, 0), Vector2d(-1, 0), Vector2d(0, 1)}))
      << "a gap of exactly 180 degrees";
}

TEST(UnionCone, HoldsExactlyThePointsOfSomeCone) {
  std::mt19937_64 random(2);
  int inside = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const Region region = regionFrom(randomPoint(0.05, random), randomPoint(0.05, random));
    const Polygon cone = unionCone(region, kFriction, box(0.3));
    for (int i = 0; i < 100; ++i) {
      const Vector2d x = randomPoint(0.3, random);
      const bool expected = inSomeCone(region, x, kFriction);
      // The sampled definition has small gaps near the region: not decided there.
      if (expected != inSomeCone(region, x, 0.98 * kFriction) ||
          expected != inSomeCone(region, x, 1.02 * kFriction))
        continue;
      EXPECT_EQ(containsPoint(cone, x), expected) << "at " << x.transpose();
      inside += expected;
    }
  }
  EXPECT_GT(inside, 100);
}

// Triples of an equilateral triangle's sides: everything is known.
TEST(Triplets, OfAnEquilateralTriangleFocusInItsMiddle) {
  std::vector<Region> regions;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * std::numbers::pi * i / 3;
    const Vector2d out(std::cos(angle), std::sin(angle)), t(-out.y(), out.x());
    regions.push_back(regionFrom(0.03 * out - 0.02 * t, 0.03 * out + 0.02 * t));
  }
  const Triplets found = findTriplets(regions, flatImage());
  ASSERT_EQ(found.triplets.size(), 1u);
  const Triplet& triplet = found.triplets[0];
  EXPECT_LT(triplet.focus_F.norm(), 1e-12);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT((triplet.points_F[i] - 0.5 * (regions[i].a_F + regions[i].b_F)).norm(), 1e-12);
    EXPECT_LT((triplet.normals_F[i] - regions[i].normal_F).norm(), 1e-12);
    EXPECT_NEAR(triplet.nearest_depth_m[i], 0.02, 0.0003);
    EXPECT_NEAR(triplet.farthest_depth_m[i], 0.02, 0.0003);
  }
}

TEST(Triplets, FocusAndAreaAgreeWithMonteCarlo) {
  std::mt19937_64 random(3);
  int checked = 0;
  for (int trial = 0; trial < 12; ++trial) {
    const auto regions = randomRegions(6, random);
    for (const Triplet& triplet : findTriplets(regions, flatImage()).triplets) {
      if (triplet.focus_area_m2 < 2e-4 || triplet.focus_area_m2 > 0.01 || ++checked > 8) continue;
      Vector2d sum = Vector2d::Zero();
      int hits = 0;
      const int samples = 6000;
      for (int i = 0; i < samples; ++i) {
        const Vector2d x = triplet.focus_F + randomPoint(0.15, random);
        const bool common = std::all_of(triplet.regions.begin(), triplet.regions.end(),
                                        [&](int r) { return inSomeCone(regions[r], x, kFriction, 120); });
        if (!common) continue;
        sum += x;
        ++hits;
      }
      const double share = static_cast<double>(hits) / samples, area = share * 0.3 * 0.3;
      const double deviation = 0.3 * 0.3 * std::sqrt(share * (1 - share) / samples);
      EXPECT_NEAR(triplet.focus_area_m2, area, 4 * deviation + 0.03 * area);
      EXPECT_LT((triplet.focus_F - sum / hits).norm(), 4 * std::sqrt(area / hits) + 1e-4);
    }
  }
  EXPECT_GE(checked, 8);
}

// The definition, region by region, without any early rejection.
std::set<std::array<int, 3>> tripletsByDefinition(const std::vector<Region>& regions, double end_margin_m) {
  std::set<std::array<int, 3>> found;
  const int n = static_cast<int>(regions.size());
  for (int i = 0; i < n; ++i) {
    for (int j = i + 1; j < n; ++j) {
      for (int k = j + 1; k < n; ++k) {
        const std::array<int, 3> triple{i, j, k};
        std::array<Vector2d, 3> normals, feet;
        Polygon common = box(500);
        for (int f = 0; f < 3; ++f) {
          normals[f] = regions[triple[f]].normal_F;
          common = unionCone(regions[triple[f]], kFriction, common);
        }
        if (!positivelySpan(normals) || signedArea(common) <= 0) continue;
        const Vector2d focus = centroid(common);
        for (int f = 0; f < 3; ++f) {
          const Region& region = regions[triple[f]];
          const double length = region.length(), margin = std::min(end_margin_m, length / 2);
          const double s = (focus - region.a_F).dot(region.b_F - region.a_F) / length;
          feet[f] = region.a_F + std::clamp(s, margin, length - margin) / length * (region.b_F - region.a_F);
        }
        Polygon triangle(feet.begin(), feet.end());
        if (signedArea(triangle) < 0) std::reverse(triangle.begin(), triangle.end());
        if (containsPoint(triangle, focus)) found.insert(triple);
      }
    }
  }
  return found;
}

TEST(Triplets, AreThoseOfTheDefinition) {
  std::mt19937_64 random(4);
  std::size_t total = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const auto regions = randomRegions(3 + trial % 12, random);
    const Triplets found = findTriplets(regions, flatImage());
    std::set<std::array<int, 3>> triples;
    for (const auto& triplet : found.triplets) triples.insert(triplet.regions);
    EXPECT_EQ(triples, tripletsByDefinition(regions, TripletOptions{}.end_margin_m));
    EXPECT_EQ(triples.size(), found.triplets.size()) << "none twice";
    total += triples.size();
  }
  EXPECT_GT(total, 100u);
}

TEST(Triplets, EveryOneHoldsWhatItPromises) {
  std::mt19937_64 random(5);
  const double cone = std::atan(kFriction);
  int unclamped = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const auto regions = randomRegions(12, random);
    for (const Triplet& triplet : findTriplets(regions, flatImage()).triplets) {
      EXPECT_TRUE(positivelySpan(triplet.normals_F));
      EXPECT_GT(triplet.focus_area_m2, 0.0);
      Polygon triangle(triplet.points_F.begin(), triplet.points_F.end());
      EXPECT_GT(std::abs(signedArea(triangle)), 0.0);
      for (int f = 0; f < 3; ++f) {
        const Region& region = regions[triplet.regions[f]];
        const Vector2d p = triplet.points_F[f];
        const double s = (p - region.a_F).dot(region.b_F - region.a_F) / region.length();
        const double margin = std::min(0.0115, region.length() / 2);
        EXPECT_GE(s, margin - 1e-12);
        EXPECT_LE(s, region.length() - margin + 1e-12);
        EXPECT_TRUE(inSomeCone(region, triplet.focus_F, kFriction * 1.001))
            << "some point of the region reaches the focus";
        if (s < margin + 1e-9 || s > region.length() - margin - 1e-9) continue;
        const double tilt = std::acos(std::min(1.0, (triplet.focus_F - p).normalized().dot(region.normal_F)));
        EXPECT_LE(tilt, cone) << "the foot of the focus pushes towards it within the cone";
        EXPECT_LT(tilt, 1e-6) << "and square to the region";
        ++unclamped;
      }
    }
  }
  EXPECT_GT(unclamped, 50);
}

TEST(Triplets, MirroredRegionsGiveMirroredTriplets) {
  std::mt19937_64 random(6);
  const auto mirror = [](const Vector2d& p) { return Vector2d(-p.x(), p.y()); };
  for (int trial = 0; trial < 20; ++trial) {
    const auto regions = randomRegions(10, random);
    std::vector<Region> mirrored;
    for (const auto& r : regions) mirrored.push_back(regionFrom(mirror(r.b_F), mirror(r.a_F)));
    const auto found = findTriplets(regions, flatImage()).triplets;
    const auto other = findTriplets(mirrored, flatImage()).triplets;
    ASSERT_EQ(found.size(), other.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].regions, other[i].regions);
      EXPECT_LT((mirror(found[i].focus_F) - other[i].focus_F).norm(), 1e-9);
      EXPECT_NEAR(found[i].focus_area_m2, other[i].focus_area_m2, 1e-9);
      for (int f = 0; f < 3; ++f)
        EXPECT_LT((mirror(found[i].points_F[f]) - other[i].points_F[f]).norm(), 1e-9);
    }
  }
}

TEST(Triplets, MoreFrictionNeverLosesATripleOfCones) {
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 10; ++trial) {
    const auto regions = randomRegions(10, random);
    std::size_t apart = regions.size() * regions.size() * regions.size();
    for (const double friction : {0.1, 0.2, 0.4, 0.8}) {
      const auto counts = findTriplets(regions, flatImage(), {.friction = friction}).counts;
      EXPECT_LE(counts.cones_apart, apart) << "friction " << friction;
      apart = counts.cones_apart;
    }
  }
}

TEST(Triplets, EveryTripleIsAccountedFor) {
  std::mt19937_64 random(8);
  for (const std::size_t most : {1u, 5u, 2000u}) {
    const auto regions = randomRegions(14, random);
    const Triplets found = findTriplets(regions, flatImage(), {.max_triplets = most});
    const TripletCounts& c = found.counts;
    EXPECT_EQ(c.considered, 14u * 13 * 12 / 6);
    EXPECT_EQ(c.considered,
              c.not_spanning + c.cones_apart + c.focus_outside + c.over_limit + found.triplets.size());
    EXPECT_LE(found.triplets.size(), most);
  }
}

TEST(Triplets, TheLimitKeepsTheLargestFocusAreas) {
  std::mt19937_64 random(9);
  const auto regions = randomRegions(20, random);
  auto all = findTriplets(regions, flatImage()).triplets;
  ASSERT_GT(all.size(), 20u);
  const auto few = findTriplets(regions, flatImage(), {.max_triplets = 10}).triplets;
  ASSERT_EQ(few.size(), 10u);
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return a.focus_area_m2 > b.focus_area_m2; });
  std::set<std::array<int, 3>> expected, kept;
  for (int i = 0; i < 10; ++i) expected.insert(all[i].regions);
  for (const auto& triplet : few) kept.insert(triplet.regions);
  EXPECT_EQ(kept, expected);
  EXPECT_TRUE(std::is_sorted(few.begin(), few.end(),
                             [](const auto& a, const auto& b) { return a.regions < b.regions; }));
}

TEST(Triplets, DepthsAreThoseOfTheSurfaceInsideAndAroundTheFinger) {
  // A block of 30 mm radius on a wider base: its edge is at 20 mm, the base beside it at 60 mm, its own
  // lowest point at 80 mm.
  FaceImage image = test::drawn(161, [](const Vector2d& p) {
    return p.norm() > 0.06 ? std::nullopt : std::optional(p.norm() < 0.03 ? 0.02 : 0.06);
  });
  const auto gray = [](double depth) {
    return static_cast<std::uint8_t>(std::lround(255 - 254 * depth / test::kDepth_m));
  };
  for (std::size_t i = 0; i < image.farthest.size(); ++i) {
    if (image.farthest[i] > 0) image.farthest[i] = std::min(image.farthest[i], gray(0.07));
  }
  const Vector2d low = image.toPixel({0.027, 0});
  image.farthest[static_cast<std::size_t>(low.y()) * 161 + static_cast<std::size_t>(low.x())] = gray(0.08);
  std::vector<Region> regions;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * std::numbers::pi * i / 3;
    const Vector2d out(std::cos(angle), std::sin(angle)), t(-out.y(), out.x());
    regions.push_back(regionFrom(0.03 * out - 0.015 * t, 0.03 * out + 0.015 * t));
  }
  const auto found = findTriplets(regions, image).triplets;
  ASSERT_EQ(found.size(), 1u);
  for (int f = 0; f < 3; ++f) {
    EXPECT_NEAR(found[0].nearest_depth_m[f], 0.02, 0.0004);
    EXPECT_NEAR(found[0].farthest_depth_m[f], f == 0 ? 0.08 : 0.07, 0.0004);
  }
}

TEST(Triplets, DepthsOfAChordOutsideItsContourAreThoseWhereTheSurfaceBegins) {
  FaceImage image = test::drawnFlat(161, [](const Vector2d& p) { return p.norm() < 0.03; });
  for (auto& far : image.farthest) far = far > 0 ? 64 : 0;
  std::vector<Region> regions;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * std::numbers::pi * i / 3;
    const Vector2d out(std::cos(angle), std::sin(angle)), t(-out.y(), out.x());
    regions.push_back(regionFrom(0.036 * out - 0.015 * t, 0.036 * out + 0.015 * t));
  }
  const auto found = findTriplets(regions, image).triplets;
  ASSERT_EQ(found.size(), 1u);
  for (int f = 0; f < 3; ++f) {
    EXPECT_NEAR(found[0].nearest_depth_m[f], 0.02, 0.0004);
    EXPECT_NEAR(found[0].farthest_depth_m[f], image.depthOf(64), 1e-12);
  }
}

TEST(Triplets, FewerThanThreeRegionsGiveNone) {
  std::mt19937_64 random(10);
  for (int n = 0; n < 3; ++n)
    EXPECT_TRUE(findTriplets(randomRegions(n, random), flatImage()).triplets.empty());
}

TEST(Triplets, AnExpiredTokenStopsAndABadOptionIsNamed) {
  std::mt19937_64 random(11);
  const auto regions = randomRegions(5, random);
  EXPECT_THROW(findTriplets(regions, flatImage(), {}, StopToken(StopToken::Clock::now())), Stopped);
  try {
    findTriplets(regions, flatImage(), {.friction = -0.5});
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("triplets.friction"));
    EXPECT_THAT(error.what(), testing::HasSubstr("-0.5"));
  }
}

}  // namespace
}  // namespace boxgrasp
