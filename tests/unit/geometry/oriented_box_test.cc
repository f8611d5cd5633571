#include "boxgrasp/geometry/oriented_box.h"

#include <gtest/gtest.h>

#include "boxgrasp/base/tolerances.h"
#include "random_clouds.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

OrientedBox randomBox(std::mt19937_64& random) {
  OrientedBox box;
  box.X_CB = test::randomPose(random);
  box.extents = Vector3d(uniform(random, 0.1, 1), uniform(random, 0.1, 1), uniform(random, 0.1, 1));
  return box;
}

TEST(OrientedBox, ContainsExactlyThePointsWithinItsHalfExtents) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    const OrientedBox box = randomBox(random);
    const Vector3d p_B(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
    const bool inside = std::abs(p_B.x()) < box.extents.x() / 2 && std::abs(p_B.y()) < box.extents.y() / 2 &&
                        std::abs(p_B.z()) < box.extents.z() / 2;
    EXPECT_EQ(box.contains(box.X_CB * p_B), inside)
        << p_B.transpose() << " in extents " << box.extents.transpose();
  }
}

TEST(OrientedBox, MarginGrowsEverySide) {
  OrientedBox box;
  box.extents = Vector3d(1, 2, 4);
  EXPECT_FALSE(box.contains({0.55, 0, 0}));
  EXPECT_TRUE(box.contains({0.55, 1.05, -2.05}, 0.06));
  EXPECT_FALSE(box.contains({0.55, 1.05, -2.07}, 0.06));
}

TEST(OrientedBox, CornersSpanTheBox) {
  std::mt19937_64 random(2);
  const OrientedBox box = randomBox(random);
  PointCloud corners;
  for (const Vector3d& corner_C : box.corners()) corners.push(corner_C);
  const OrientedBox around = boxAround(corners, box.X_CB.linear());
  EXPECT_LT((around.extents - box.extents).norm(), 1e-6);
  EXPECT_LT((around.X_CB.translation() - box.X_CB.translation()).norm(), 1e-6);
}

TEST(OrientedBox, BoxAroundTouchesThePointsOnAllSixSides) {
  std::mt19937_64 random(3);
  const PointCloud cloud = test::gaussianCloud(500, {0.1, 0.2, 0.3}, random);
  const OrientedBox box = boxAround(cloud, test::randomRotation(random));
  Vector3d low = Vector3d::Ones(), high = -Vector3d::Ones();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3d p_B = box.X_CB.inverse() * cloud.point(i);
    low = low.cwiseMin(p_B);
    high = high.cwiseMax(p_B);
  }
  EXPECT_LT((high - 0.5 * box.extents).norm(), 1e-12);
  EXPECT_LT((low + 0.5 * box.extents).norm(), 1e-12);
}

TEST(OrientedBox, FlatExtentsAreRaised) {
  PointCloud cloud;
  cloud.push({1, 2, 3});
  const OrientedBox box = boxAround(cloud, Matrix3d::Identity());
  EXPECT_EQ(box.extents, Vector3d::Constant(tolerance::kFlatExtent));
  EXPECT_EQ(box.X_CB.translation(), Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace boxgrasp
