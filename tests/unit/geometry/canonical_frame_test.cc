#include "boxgrasp/geometry/canonical_frame.h"

#include <gtest/gtest.h>

#include "random_clouds.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

// Skewed along every axis, so that the signs of the axes are well defined.
PointCloud skewedCloud(std::size_t n, std::mt19937_64& random) {
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = uniform(random), y = uniform(random), z = uniform(random);
    cloud.push({0.3 * x * x, 0.2 * y * y, 0.1 * z * z});
  }
  return cloud;
}

TEST(CanonicalFrame, MovesWithTheCloud) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 50; ++round) {
    const PointCloud cloud = skewedCloud(500, random);
    const Pose X_AC = test::randomPose(random);
    const Pose moved = canonicalFrame(transformed(cloud, X_AC)), expected = X_AC * canonicalFrame(cloud);
    EXPECT_LT((moved.matrix() - expected.matrix()).norm(), 1e-5);
  }
}

TEST(CanonicalFrame, DoesNotDependOnTheOrderOfThePoints) {
  std::mt19937_64 random(2);
  for (const std::size_t n : {2u, 3u, 50u, 1000u, 30000u}) {
    const PointCloud cloud = transformed(skewedCloud(n, random), test::randomPose(random));
    const Pose first = canonicalFrame(cloud), second = canonicalFrame(test::shuffled(cloud, random));
    EXPECT_EQ(first.matrix(), second.matrix()) << n << " points: expected the same bits";
  }
}

TEST(CanonicalFrame, HasTheMeanThePrincipalAxesAndPositiveThirdMoments) {
  std::mt19937_64 random(3);
  const PointCloud cloud = transformed(skewedCloud(2000, random), test::randomPose(random));
  const Pose X_CK = canonicalFrame(cloud);
  Vector3d mean = Vector3d::Zero(), third = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3d p_K = X_CK.inverse() * cloud.point(i);
    mean += p_K / 2000.0;
    second += p_K * p_K.transpose() / 2000.0;
    third += p_K.cwiseProduct(p_K).cwiseProduct(p_K);
  }
  EXPECT_LT(mean.norm(), 1e-8);
  EXPECT_LT((second - Matrix3d(second.diagonal().asDiagonal())).norm(), 1e-8) << second;
  EXPECT_GT(second(0, 0), second(1, 1));
  EXPECT_GT(second(1, 1), second(2, 2));
  EXPECT_GT(third.x(), 0.0);
  EXPECT_GT(third.y(), 0.0);
  EXPECT_NEAR(X_CK.linear().determinant(), 1.0, 1e-12);
}

TEST(CanonicalFrame, IsAFrameForDegenerateClouds) {
  PointCloud cloud;
  for (int i = 0; i < 3; ++i) {
    cloud.push({0.25, 0.5 * i * i, 1});
    const Pose X_CK = canonicalFrame(cloud);
    EXPECT_LT((X_CK.linear().transpose() * X_CK.linear() - Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(X_CK.linear().determinant(), 1.0, 1e-12);
    cloud.push(cloud.point(0));
  }
}

TEST(CanonicalFrame, IsAccurateFarFromTheOriginAndForAnyUnit) {
  std::mt19937_64 random(4);
  const PointCloud cloud = skewedCloud(500, random);
  const Pose X_CK = canonicalFrame(cloud);
  for (const double scale : {1e-30, 1e-3, 1e3, 1e9}) {
    PointCloud scaled;
    for (std::size_t i = 0; i < cloud.size(); ++i) scaled.push(scale * cloud.point(i));
    const Pose other = canonicalFrame(scaled);
    EXPECT_LT((other.linear() - X_CK.linear()).norm(), 1e-5) << "scale " << scale;
    EXPECT_LT((other.translation() / scale - X_CK.translation()).norm(), 1e-6) << "scale " << scale;
  }
}

}  // namespace
}  // namespace boxgrasp
