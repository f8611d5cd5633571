#include "boxgrasp/geometry/point_cloud.h"

#include <gtest/gtest.h>

#include "random_clouds.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

TEST(PointCloud, RangesAgreeWithBruteForceForEverySize) {
  std::mt19937_64 random(1);
  for (std::size_t n = 1; n < 140; ++n) {
    const PointCloud cloud = test::gaussianCloud(n, {0.1, 0.2, 0.3}, random);
    const Matrix3d axes = test::randomRotation(random);
    AxisRanges expected{axes.transpose() * cloud.point(0), axes.transpose() * cloud.point(0)};
    for (std::size_t i = 0; i < n; ++i) {
      expected.min = expected.min.cwiseMin(axes.transpose() * cloud.point(i));
      expected.max = expected.max.cwiseMax(axes.transpose() * cloud.point(i));
    }
    const AxisRanges ranges = rangesAlong(cloud, axes);
    EXPECT_LT((ranges.min - expected.min).norm(), 1e-14) << n << " points";
    EXPECT_LT((ranges.max - expected.max).norm(), 1e-14) << n << " points";
  }
}

TEST(PointCloud, BoundsAreExact) {
  PointCloud cloud;
  cloud.push({1, -2, 3});
  cloud.push({-4, 5, 0.1});
  EXPECT_EQ(bounds(cloud).min(), Vector3d(-4, -2, 0.1f));
  EXPECT_EQ(bounds(cloud).max(), Vector3d(1, 5, 3));
  EXPECT_TRUE(bounds(PointCloud()).isEmpty());
}

TEST(PointCloud, TransformRoundsTheExactPointOnce) {
  std::mt19937_64 random(2);
  const PointCloud cloud = test::gaussianCloud(77, {1, 1, 1}, random);
  const Pose X_BA = test::randomPose(random);
  const PointCloud moved = transformed(cloud, X_BA);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3d error = moved.point(i) - X_BA * cloud.point(i);
    EXPECT_LE(error.cwiseAbs().maxCoeff(), 0x1p-24 * 8.0)
        << "more than half a unit in the last place of a number below 8";
  }
}

TEST(PointCloud, TransformsCompose) {
  std::mt19937_64 random(3);
  const PointCloud cloud = test::gaussianCloud(50, {1, 1, 1}, random);
  const Pose X_BA = test::randomPose(random), X_CB = test::randomPose(random);
  const PointCloud twice = transformed(transformed(cloud, X_BA), X_CB),
                   once = transformed(cloud, X_CB * X_BA);
  for (std::size_t i = 0; i < cloud.size(); ++i) EXPECT_LT((twice.point(i) - once.point(i)).norm(), 1e-5);
}

TEST(PointCloud, SelectKeepsTheGivenOrder) {
  PointCloud cloud;
  for (int i = 0; i < 5; ++i) cloud.push({1.0 * i, 10.0 * i, 100.0 * i});
  const PointCloud selected = select(cloud, {3, 0, 3});
  ASSERT_EQ(selected.size(), 3u);
  EXPECT_EQ(selected.point(0), Vector3d(3, 30, 300));
  EXPECT_EQ(selected.point(1), Vector3d(0, 0, 0));
  EXPECT_EQ(selected.point(2), selected.point(0));
  EXPECT_TRUE(select(cloud, {}).empty());
}

}  // namespace
}  // namespace boxgrasp
