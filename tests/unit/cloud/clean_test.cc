#include "boxgrasp/cloud/clean.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/cloud/neighbours.h"
#include "boxgrasp/geometry/point_grid.h"
#include "boxgrasp/geometry/voxels.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// A lopsided body: half an ellipsoid's surface, so that its canonical frame is well defined.
PointCloud shell(std::size_t n, std::mt19937_64& random) {
  PointCloud cloud;
  while (cloud.size() < n) {
    const Vector3d d = Vector3d(normal(random), normal(random), normal(random)).normalized();
    if (d.x() + 0.3 * d.y() > -0.2) cloud.push(d.cwiseProduct(Vector3d(0.06, 0.04, 0.025)));
  }
  return cloud;
}

PointCloud shuffled(const PointCloud& cloud, std::mt19937_64& random) {
  std::vector<std::uint32_t> order(cloud.size());
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[uniformIndex(random, i)]);
  return select(cloud, order);
}

CleanOptions evenOnly(double voxel_m) {
  CleanOptions options;
  options.voxel_m = voxel_m;
  options.outlier_neighbours = 0;
  return options;
}

// ---- validated()

std::string refusal(const PointCloud& cloud, const ValidationOptions& options = {}) {
  try {
    validated(cloud, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

PointCloud cloudOf(std::initializer_list<Vector3d> points) {
  PointCloud cloud;
  for (const Vector3d& p : points) cloud.push(p);
  return cloud;
}

TEST(Validated, DropsNonFinitePoints) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const auto finite = validated(cloudOf({{nan, 0, 0}, {0, 0, 0}, {0, inf, 0}, {0.1, 0, 0}, {0, 0, -inf}}));
  EXPECT_EQ(finite.cloud_C, cloudOf({{0, 0, 0}, {0.1, 0, 0}}));
  EXPECT_EQ(finite.non_finite, 3u);
}

TEST(Validated, SaysWhatIsWrongAndWhatHelps) {
  const double nan = std::nan("");
  EXPECT_THAT(refusal({}), HasSubstr("empty"));
  EXPECT_THAT(refusal(cloudOf({{nan, 0, 0}, {0, nan, 0}})),
              AllOf(HasSubstr("none of"), HasSubstr("2 points")));
  EXPECT_THAT(refusal(cloudOf({{1, 2, 3}, {nan, 0, 0}})), HasSubstr("one finite point"));
  EXPECT_THAT(refusal(cloudOf({{1, 2, 3}, {1, 2, 3}})), AllOf(HasSubstr("one spot"), HasSubstr("(1, 2, 3)")));
  EXPECT_THAT(refusal(cloudOf({{0, 0, 0}, {0.0005, 0, 0}})),
              AllOf(HasSubstr("below min_extent_m"), HasSubstr("--scale 1000")));
  EXPECT_THAT(refusal(cloudOf({{0, 0, 0}, {0, 100, 0}})),
              AllOf(HasSubstr("100 m"), HasSubstr("above max_extent_m = 20"), HasSubstr("--scale 0.001")));
  EXPECT_THAT(refusal(cloudOf({{5000, 0, 0}, {5001, 0, 0}})),
              AllOf(HasSubstr("5001 m"), HasSubstr("offset")));
  EXPECT_EQ(refusal(cloudOf({{0, 0, 0}, {0, 0, 19.9}})), "accepted");
  ValidationOptions options;
  options.max_extent_m = 0.0;
  EXPECT_THAT(refusal(cloudOf({{0, 0, 0}, {0, 0, 1}}), options), HasSubstr("'max_extent_m'"));
}

// ---- clean()

TEST(Clean, TheOrderOfThePointsDoesNotMatterToTheBit) {
  std::mt19937_64 random(1);
  const PointCloud cloud = shell(20'000, random);
  for (const double voxel_m : {0.0, 0.0015, 0.01}) {
    CleanOptions options;
    options.voxel_m = voxel_m;
    const CleanCloud expected = clean(cloud, options);
    for (int round = 0; round < 3; ++round) {
      const CleanCloud result = clean(shuffled(cloud, random), options);
      EXPECT_EQ(result.cloud_C, expected.cloud_C) << "voxels of " << voxel_m;
      EXPECT_EQ(result.spacing_m, expected.spacing_m);
      EXPECT_EQ(result.merged, expected.merged);
    }
  }
}

// A point within rounding, some 1e-8 m, of a voxel's border may change sides, and then its voxel's mean
// moves: one voxel in a thousand may have no counterpart.
TEST(Clean, ARigidMotionMovesTheResultWithIt) {
  std::mt19937_64 random(2);
  const PointCloud cloud_C = shell(20'000, random);
  for (const double voxel_m : {0.0015, 0.005}) {
    const CleanCloud before = clean(cloud_C, evenOnly(voxel_m));
    for (int round = 0; round < 10; ++round) {
      const Pose X_DC = test::randomPose(random, 0.5);
      const CleanCloud after = clean(transformed(cloud_C, X_DC), evenOnly(voxel_m));
      const PointCloud expected = transformed(before.cloud_C, X_DC);
      const PointGrid grid(expected, 0.001);
      std::size_t alone = 0;
      for (std::size_t i = 0; i < after.cloud_C.size(); ++i)
        alone += !grid.nearest(after.cloud_C.point(i), 1e-5);
      EXPECT_LE(alone, expected.size() / 1000) << "round " << round << ", voxels of " << voxel_m;
      EXPECT_NEAR(static_cast<double>(after.cloud_C.size()), static_cast<double>(expected.size()), 3.0);
    }
  }
}

TEST(Clean, APointIsTheMeanOfItsVoxelAndEveryPointIsCounted) {
  std::mt19937_64 random(3);
  const PointCloud cloud = shell(3'000, random);
  const CleanCloud result = clean(cloud, evenOnly(0.004));
  EXPECT_EQ(result.cloud_C.size() + result.merged + result.duplicates, cloud.size());
  EXPECT_EQ(result.voxel_m, 0.004);
  EXPECT_EQ(result.outliers, 0u);
  Vector3d sum = Vector3d::Zero();
  const Voxels voxels = sortIntoVoxels(cloud, 0.004);
  const PointCloud means = meansOf(cloud, voxels);
  for (std::size_t i = 0; i < means.size(); ++i) {
    Vector3d mean = Vector3d::Zero();
    for (const std::uint32_t j : voxels.points(i))
      mean += cloud.point(j) / static_cast<double>(voxels.points(i).size());
    EXPECT_LT((means.point(i) - mean).norm(), 5e-8);
    for (const std::uint32_t j : voxels.points(i)) {
      EXPECT_LE((cloud.point(j) - mean).cwiseAbs().maxCoeff(), 0.004 + 1e-9)
          << "a voxel larger than its edge";
    }
    sum += mean * static_cast<double>(voxels.points(i).size());
  }
  for (std::size_t i = 0; i < cloud.size(); ++i) sum -= cloud.point(i);
  EXPECT_LT(sum.norm(), 1e-6) << "every point must be in one voxel";
}

// On a lattice, where many points coincide, some of them at 0 and -0; voxels of a few points and of hundreds.
TEST(Clean, AsManyPlacesAreCountedAsThereAre) {
  std::mt19937_64 random(8);
  for (const double voxel_m : {0.002, 0.004, 0.02}) {
    for (const int points : {30, 300, 3000}) {
      PointCloud cloud;
      std::set<std::array<int, 3>> places;
      for (int i = 0; i < points; ++i) {
        const std::array<int, 3> place{static_cast<int>(uniformIndex(random, 9)) - 4,
                                       static_cast<int>(uniformIndex(random, 9)) - 4,
                                       static_cast<int>(uniformIndex(random, 9)) - 4};
        places.insert(place);
        const double zero = i % 2 == 0 ? 0.0 : -0.0;
        const auto coordinate = [&](int steps) { return steps == 0 ? zero : 0.001 * steps; };
        cloud.push(Vector3d(coordinate(place[0]), coordinate(place[1]), coordinate(place[2])));
      }
      EXPECT_EQ(clean(cloud, evenOnly(voxel_m)).duplicates, cloud.size() - places.size())
          << points << " points, voxels of " << voxel_m << " m";
    }
  }
}

TEST(Clean, DuplicatesAreCountedAndAddNoPoints) {
  std::mt19937_64 random(4);
  const PointCloud cloud = shell(2'000, random);
  const PointCloud thrice = shuffled(joined(joined(cloud, cloud), cloud), random);
  for (const double voxel_m : {0.0, 0.003}) {
    const CleanCloud once = clean(cloud, evenOnly(voxel_m)), result = clean(thrice, evenOnly(voxel_m));
    EXPECT_EQ(result.duplicates, 4'000u);
    EXPECT_EQ(result.merged, once.merged);
    ASSERT_EQ(result.cloud_C.size(), once.cloud_C.size());
    for (std::size_t i = 0; i < once.cloud_C.size(); ++i) {
      EXPECT_LT((result.cloud_C.point(i) - once.cloud_C.point(i)).norm(), 1e-7);
    }
  }
  EXPECT_EQ(clean(thrice, evenOnly(0.0)).cloud_C.size(), 2'000u);
}

TEST(Clean, PlantedOutliersGoAndTheSurfaceStays) {
  std::mt19937_64 random(5);
  const PointCloud cloud = shell(40'000, random);
  PointCloud outliers;
  for (int i = 0; i < 20; ++i) {
    outliers.push(0.12 * Vector3d(normal(random), normal(random), normal(random)).normalized());
  }
  const CleanCloud result = clean(joined(cloud, outliers));
  EXPECT_EQ(result.outliers, 20u);
  for (std::size_t i = 0; i < result.cloud_C.size(); ++i) EXPECT_LT(result.cloud_C.point(i).norm(), 0.07);
}

TEST(Clean, AnOutlierFarAwayCostsNoMemoryAndNoTime) {
  std::mt19937_64 random(6);
  PointCloud cloud = shell(20'000, random);
  cloud.push({19, 0, 0});
  cloud.push({0, 19, 0});
  const CleanCloud result = clean(cloud);
  EXPECT_EQ(result.outliers, 2u);
}

TEST(Clean, VoxelsGrowUntilTheCloudFits) {
  std::mt19937_64 random(7);
  const PointCloud cloud = shell(50'000, random);
  CleanOptions options;
  options.max_points = 1'000;
  const CleanCloud result = clean(cloud, options);
  EXPECT_GT(result.voxel_m, options.voxel_m);
  EXPECT_LE(result.cloud_C.size() + result.outliers, 1'000u);
  EXPECT_GE(result.cloud_C.size() + result.outliers, 700u) << "voxels grew further than they had to";
}

TEST(Clean, SpacingIsThatOfAGrid) {
  PointCloud grid;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 40; ++j) grid.push({0.002 * i, 0.002 * j, 0.0});
  }
  CleanOptions options;
  options.voxel_m = 0.0;
  EXPECT_NEAR(clean(grid, options).spacing_m, 0.002, 1e-7);
}

TEST(Clean, FewPointsAreKept) {
  const PointCloud two = cloudOf({{0, 0, 0}, {0.1, 0, 0}});
  const CleanCloud result = clean(two);
  EXPECT_EQ(result.cloud_C.size(), 2u);
  EXPECT_NEAR(result.spacing_m, 0.1, 1e-6);
  const CleanCloud one = clean(cloudOf({{0, 0, 0}, {0.0005, 0, 0}}));
  EXPECT_EQ(one.cloud_C.size(), 1u);
  EXPECT_EQ(one.spacing_m, -1.0);
}

TEST(Clean, AnExpiredDeadlineStops) {
  std::mt19937_64 random(8);
  EXPECT_THROW(clean(shell(100, random), {}, StopToken(StopToken::Clock::now())), Stopped);
}

TEST(CleanOptions, BadValuesAreNamed) {
  for (const double voxel_m : {-1.0, 1e-9, 2.0, std::nan("")}) {
    CleanOptions options;
    options.voxel_m = voxel_m;
    EXPECT_THROW(options.validate(), InputError) << voxel_m;
  }
  CleanOptions options;
  options.outlier_deviations = 0.0;
  EXPECT_THROW(options.validate(), InputError);
}

TEST(Clean, IsTheSameOnAnyNumberOfThreads) {
  std::mt19937_64 random(8);
  PointCloud cloud = shell(20'000, random);
  cloud.push({0.3, 0.3, 0.3});
  CleanOptions options;
  const CleanCloud one = clean(cloud, options);
  options.threads = 3;
  const CleanCloud three = clean(cloud, options);
  ASSERT_GT(one.merged, 0u);
  EXPECT_TRUE(one.cloud_C.x == three.cloud_C.x && one.cloud_C.y == three.cloud_C.y &&
              one.cloud_C.z == three.cloud_C.z);
  EXPECT_EQ(one.merged, three.merged);
  EXPECT_EQ(one.duplicates, three.duplicates);
  EXPECT_EQ(one.outliers, three.outliers);
  EXPECT_EQ(one.spacing_m, three.spacing_m);
}

// ---- the helpers against brute force

void expectAsByBruteForce(const PointCloud& cloud, int k, double radius_m) {
  const NeighbourDistances distances = neighbourDistances(cloud, k, radius_m, 1, {});
  const NeighbourDistances on_three = neighbourDistances(cloud, k, radius_m, 3, {});
  EXPECT_TRUE(on_three.mean == distances.mean && on_three.nearest == distances.nearest)
      << "the result must not depend on the number of threads; k " << k << ", radius " << radius_m;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    std::vector<double> all;
    for (std::size_t j = 0; j < cloud.size(); ++j) all.push_back((cloud.point(i) - cloud.point(j)).norm());
    std::sort(all.begin(), all.end());
    const double mean = std::accumulate(all.begin() + 1, all.begin() + 1 + k, 0.0) / k;
    EXPECT_NEAR(distances.mean[i], mean, 1e-6 * mean) << "k " << k << ", radius " << radius_m;
    EXPECT_NEAR(distances.nearest[i], all[1], 1e-6 * all[1]) << "k " << k << ", radius " << radius_m;
  }
}

TEST(NeighbourDistances, AgreeWithBruteForce) {
  std::mt19937_64 random(9);
  PointCloud cloud = shell(300, random);
  cloud.push({3, 0, 0});
  for (const int k : {1, 2, 8, 40}) {
    for (const double radius_m : {0.0003, 0.01, 10.0}) expectAsByBruteForce(cloud, k, radius_m);
  }
}

TEST(NeighbourDistances, AgreeWhereManyAreEquallyFarAndSomeCoincide) {
  PointCloud lattice;
  for (int i = 0; i < 216; ++i) lattice.push(0.25 * Vector3d(i % 6, i / 6 % 6, i / 36));
  for (int i = 0; i < 216; i += 7) {
    for (int copies = i % 4; copies > 0; --copies) lattice.push(lattice.point(i));
  }
  for (const int k : {1, 2, 3, 8, 40}) {
    for (const double radius_m : {0.1, 0.3, 0.5, 3.0}) expectAsByBruteForce(lattice, k, radius_m);
  }
}

TEST(NeighbourSweep, FindsExactlyTheVoxelsAroundEach) {
  std::mt19937_64 random(10);
  for (const Vector3d& size : {Vector3d(8, 8, 8), Vector3d(0.2, 9, 9), Vector3d(9, 0.2, 9),
                               Vector3d(0.2, 0.2, 20), Vector3d(30, 0, 0)}) {
    PointCloud cloud;
    for (int i = 0; i < 200; ++i) {
      cloud.push({size.x() * uniform(random), size.y() * uniform(random), size.z() * uniform(random)});
    }
    const Voxels voxels = sortIntoVoxels(cloud, 1.0);
    const auto cell = [&](std::size_t v) {
      return Vector3d((cloud.point(voxels.points(v)[0]).array() + 0.5).floor());
    };
    NeighbourSweep sweep(voxels);
    for (std::size_t v = 0; v < voxels.size(); ++v) {
      std::multiset<std::size_t> expected, found;
      for (std::size_t other = 0; other < voxels.size(); ++other) {
        if ((cell(other) - cell(v)).cwiseAbs().maxCoeff() <= 1.0) expected.insert(other);
      }
      const auto collect = [&](std::size_t first, std::size_t last) {
        for (; first < last; ++first) found.insert(first);
      };
      sweep.around(v, collect);
      EXPECT_EQ(found, expected) << "voxel " << v << " of a cloud of size " << size.transpose();
      found.clear();
      NeighbourSweep(voxels, v).around(v, collect);
      EXPECT_EQ(found, expected) << "begun at voxel " << v << " of a cloud of size " << size.transpose();
    }
  }
}

}  // namespace
}  // namespace boxgrasp
