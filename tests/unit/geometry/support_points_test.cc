#include "boxgrasp/geometry/support_points.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "random_clouds.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

TEST(BlockRanges, HoldTheValuesAndTouchTheOutermost) {
  std::mt19937_64 random(1);
  for (const std::size_t n : {1u, 15u, 16u, 17u, 100u, 1000u}) {
    std::vector<float> values;
    for (std::size_t i = 0; i < n; ++i) values.push_back(static_cast<float>(normal(random)));
    const BlockRanges ranges = blockRanges(values, 48);
    ASSERT_EQ(ranges.size(), (n + 47) / 48);
    EXPECT_EQ(ranges.all.min, *std::ranges::min_element(values));
    EXPECT_EQ(ranges.all.max, *std::ranges::max_element(values));
    for (std::size_t b = 0; b < ranges.size(); ++b) {
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(48 * b);
      const auto end = values.begin() + static_cast<std::ptrdiff_t>(std::min(n, 48 * (b + 1)));
      const auto [low, high] = std::minmax_element(begin, end);
      EXPECT_NEAR(ranges.middle[b] - ranges.half[b], *low, 1e-6);
      EXPECT_NEAR(ranges.middle[b] + ranges.half[b], *high, 1e-6);
    }
  }
}

TEST(PlacesAbove, AreThoseOfALoop) {
  std::mt19937_64 random(3);
  for (const std::size_t n : {0u, 1u, 15u, 16u, 17u, 500u}) {
    std::vector<float> values;
    for (std::size_t i = 0; i < n; ++i) values.push_back(static_cast<float>(uniformIndex(random, 40)));
    for (const float limit : {-1.0f, 20.0f, 38.0f, 39.0f}) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t i = 0; i < n; ++i) {
        if (values[i] > limit) expected.push_back(i);
      }
      EXPECT_EQ(placesAbove(values, limit), expected) << n << " values, limit " << limit;
    }
  }
}

// In whatever order the points are, and however few of them are looked at.
TEST(SupportPoints, AreTheLowestAndHighestOfAll) {
  std::mt19937_64 random(2);
  for (const std::size_t n : {1u, 255u, 256u, 257u, 5000u}) {
    PointCloud cloud = test::gaussianCloud(n, {0.1, 0.05, 0.02}, random);
    if (n == 5000) std::sort(cloud.x.begin(), cloud.x.end());  // blocks that are far apart
    const SupportPoints supports(cloud);
    for (int round = 0; round < 20; ++round) {
      const Matrix3d directions = test::randomPose(random).linear();
      const Vector3d origin(0.1 * normal(random), 0.0, 0.3);
      PointCloud found;
      supports.append(origin, {directions.col(0), directions.col(1), directions.col(2)}, found);
      ASSERT_EQ(found.size(), 6u);
      const AxisRanges all = rangesAlong(cloud, directions);
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3d direction = directions.col(axis);
        EXPECT_NEAR(direction.dot(found.point(2 * static_cast<std::size_t>(axis))), all.min[axis], 1e-6);
        EXPECT_NEAR(direction.dot(found.point(2 * static_cast<std::size_t>(axis) + 1)), all.max[axis], 1e-6);
      }
    }
  }
}

TEST(SupportPoints, HaveTheRangesOfAllPointsToTheLastBit) {
  std::mt19937_64 random(4);
  for (const std::size_t n : {1u, 255u, 256u, 257u, 5000u}) {
    PointCloud cloud =
        transformed(test::gaussianCloud(n, {0.1, 0.05, 0.02}, random), test::randomPose(random));
    if (n == 5000) std::sort(cloud.x.begin(), cloud.x.end());  // blocks that are far apart
    const SupportPoints supports(cloud);
    EXPECT_EQ(supports.bounds().min(), bounds(cloud).min());
    EXPECT_EQ(supports.bounds().max(), bounds(cloud).max());
    for (int round = 0; round < 50; ++round) {
      const Matrix3d axes = round == 0 ? Matrix3d(Matrix3d::Identity()) : test::randomPose(random).linear();
      const AxisRanges ranges = supports.ranges(axes), expected = rangesAlong(cloud, axes);
      EXPECT_EQ(ranges.min, expected.min);
      EXPECT_EQ(ranges.max, expected.max);
    }
  }
}

TEST(SupportPoints, AreTheSmallestOfEquals) {
  PointCloud cloud;
  for (int i = 999; i >= 0; --i) cloud.push({0.0, 0.001 * (i % 500), 1.0});
  PointCloud found;
  SupportPoints(cloud).append({0, 0, 0}, {Vector3d::UnitX()}, found);
  for (const std::size_t along_x : {0u, 1u})
    EXPECT_EQ(found.point(along_x), cloud.point(499)) << "all are equal along x";
}

}  // namespace
}  // namespace boxgrasp
