#include "boxgrasp/geometry/surface_normal.h"

#include <gtest/gtest.h>

#include "random_pose.h"

namespace boxgrasp {
namespace {

constexpr double kCell_m = 0.005;

PointCloud cloudOf(const std::vector<Vector3d>& points) {
  PointCloud cloud;
  for (const Vector3d& p : points) cloud.push(p);
  return cloud;
}

double angleBetweenLines(const Vector3d& a, const Vector3d& b) {
  return std::asin(std::min(1.0, a.cross(b).norm()));
}

// A square of points every 2 mm, in the plane z = 0 of a random frame.
TEST(FitSurface, FindsAPlaneInAnyPose) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose X = test::randomPose(random, 2.0);
    PointCloud cloud;
    for (int i = -10; i <= 10; ++i) {
      for (int j = -10; j <= 10; ++j) cloud.push(X * Vector3d(0.002 * i, 0.002 * j, 0));
    }
    const auto plane = fitSurface(PointGrid(cloud, kCell_m), X * Vector3d(0, 0, 0.001), 0.008);
    ASSERT_TRUE(plane);
    EXPECT_NEAR(plane->normal.norm(), 1.0, 1e-12);
    EXPECT_LT(angleBetweenLines(plane->normal, X.linear().col(2)), 1e-4)
        << "floats round to a tenth of a micrometre";
    EXPECT_LT((plane->centroid - X.translation()).norm(), 1e-6);
    EXPECT_LT(plane->flatness, 1e-8);
    EXPECT_LT((plane->project(X * Vector3d(0.003, 0.004, 0.005)) - X * Vector3d(0.003, 0.004, 0)).norm(),
              1e-6);
  }
}

// On a sphere the normal is radial, to within the unevenness of the sample.
TEST(FitSurface, IsRadialOnASphere) {
  std::mt19937_64 random(2);
  constexpr double kRadius = 0.05;
  PointCloud cloud;
  for (int i = 0; i < 20000; ++i)
    cloud.push(kRadius * Vector3d(normal(random), normal(random), normal(random)).normalized());
  const PointGrid grid(cloud, kCell_m);
  for (int trial = 0; trial < 100; ++trial) {
    const Vector3d radial = Vector3d(normal(random), normal(random), normal(random)).normalized();
    const auto plane = fitSurface(grid, kRadius * radial, 0.008);
    ASSERT_TRUE(plane);
    EXPECT_LT(angleBetweenLines(plane->normal, radial), 0.03);
  }
}

TEST(FitSurface, FlatnessOfABallIsAThird) {
  std::mt19937_64 random(3);
  PointCloud cloud;
  for (int i = 0; i < 50000; ++i)
    cloud.push({uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)});
  const auto plane = fitSurface(PointGrid(cloud, 0.1), Vector3d::Zero(), 0.9);
  ASSERT_TRUE(plane);
  EXPECT_NEAR(plane->flatness, 1.0 / 3.0, 0.01);
}

TEST(FitSurface, RefusesWhatSpansNoPlane) {
  const auto fit = [](const std::vector<Vector3d>& points) {
    const PointCloud cloud = cloudOf(points);
    return fitSurface(PointGrid(cloud, kCell_m), Vector3d::Zero(), 0.01);
  };
  EXPECT_FALSE(fit({})) << "no point";
  EXPECT_FALSE(fit({{0, 0, 0}, {0.001, 0, 0}})) << "two points";
  EXPECT_FALSE(fit({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}})) << "one point four times";
  EXPECT_FALSE(fit({{-0.002, 0, 0}, {0, 0, 0}, {0.001, 0, 0}, {0.003, 0, 0}})) << "a line";
  EXPECT_FALSE(fit({{1, 0, 0}, {1, 1, 0}, {0, 1, 0}})) << "all out of reach";
  EXPECT_TRUE(fit({{0, 0, 0}, {0.001, 0, 0}, {0, 0.001, 0}})) << "a triangle";
}

}  // namespace
}  // namespace boxgrasp
