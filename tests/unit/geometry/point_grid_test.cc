#include "boxgrasp/geometry/point_grid.h"

#include <gtest/gtest.h>

#include <set>

#include "random_clouds.h"

namespace boxgrasp {
namespace {

std::vector<std::uint32_t> withinByBruteForce(const PointCloud& cloud, const Vector3d& p, double radius) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if ((cloud.point(i) - p).norm() <= radius) found.push_back(i);
  }
  return found;
}

std::optional<std::uint32_t> nearestByBruteForce(const PointCloud& cloud, const Vector3d& p, double radius) {
  std::optional<std::uint32_t> best;
  for (const std::uint32_t i : withinByBruteForce(cloud, p, radius)) {
    if (!best || (cloud.point(i) - p).norm() < (cloud.point(*best) - p).norm()) best = i;
  }
  return best;
}

Vector3d randomPoint(std::mt19937_64& random, double reach) {
  const double x = uniform(random, -reach, reach), y = uniform(random, -reach, reach);
  return {x, y, uniform(random, -reach, reach)};
}

void expectAgreesWithBruteForce(const PointCloud& cloud, double cell_m, double reach,
                                std::mt19937_64& random) {
  const PointGrid grid(cloud, cell_m);
  for (int round = 0; round < 200; ++round) {
    const Vector3d p = randomPoint(random, reach);
    const double radius = std::pow(10.0, uniform(random, -3.0, 1.0));
    EXPECT_EQ(grid.within(p, radius), withinByBruteForce(cloud, p, radius))
        << p.transpose() << " radius " << radius;
    EXPECT_EQ(grid.nearest(p, radius), nearestByBruteForce(cloud, p, radius))
        << p.transpose() << " radius " << radius;
  }
}

TEST(PointGrid, AgreesWithBruteForce) {
  std::mt19937_64 random(1);
  for (const double cell_m : {0.001, 0.03, 0.5, 100.0}) {
    expectAgreesWithBruteForce(test::gaussianCloud(500, {0.1, 0.1, 0.02}, random), cell_m, 0.3, random);
  }
}

TEST(PointGrid, AgreesWithBruteForceWithFarOutliers) {
  std::mt19937_64 random(2);
  PointCloud cloud = test::gaussianCloud(300, {0.1, 0.1, 0.1}, random);
  for (const double far : {1e3, -1e6, 1e12, -3e38}) {
    cloud.push({far, 0, 0});
    cloud.push({0, far, far});
  }
  expectAgreesWithBruteForce(cloud, 0.005, 0.3, random);
  const PointGrid grid(cloud, 0.005);
  EXPECT_EQ(grid.within({-1e6f, 0, 0}, 0.1).size(), 1u);
  EXPECT_EQ(grid.nearest({1e12, 1.0, 0}, 1e11), nearestByBruteForce(cloud, {1e12, 1.0, 0}, 1e11));
  EXPECT_EQ(grid.within({0, 0, 0}, 1e39).size(), cloud.size());
}

TEST(PointGrid, NearestTakesTheSmallerIndexOfEquals) {
  PointCloud cloud;
  for (int i = 0; i < 4; ++i) cloud.push({i % 2 ? 0.1 : -0.1, 0, 0});
  EXPECT_EQ(PointGrid(cloud, 0.07).nearest({0, 0, 0}, 1.0), 0u);
  EXPECT_EQ(PointGrid(cloud, 0.07).nearest({0.01, 0, 0}, 1.0), 1u);
}

TEST(PointGrid, VisitsEveryPointOfABoxOnceAndStops) {
  std::mt19937_64 random(3);
  const PointCloud cloud = test::boxCloud(1000, {1, 1, 1}, random);
  const PointGrid grid(cloud, 0.1);
  for (const double half : {0.02, 0.2, 5.0}) {
    const Eigen::AlignedBox3d box(Vector3d::Constant(0.1 - half), Vector3d::Constant(0.1 + half));
    std::multiset<std::uint32_t> visited;
    EXPECT_FALSE(grid.visitBox(box, [&](std::uint32_t i) {
      visited.insert(i);
      return false;
    }));
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
      EXPECT_LE(visited.count(i), 1u);
      EXPECT_TRUE(visited.contains(i) || !box.contains(cloud.point(i))) << "missed a point of the box";
    }
    int calls = 0;
    EXPECT_TRUE(grid.visitBox(box, [&](std::uint32_t) { return ++calls == 2; }));
    EXPECT_EQ(calls, 2);
  }
}

TEST(PointGrid, EmptyCloudAndEmptyBox) {
  const PointCloud none;
  EXPECT_TRUE(PointGrid(none, 0.1).within({0, 0, 0}, 1).empty());
  EXPECT_EQ(PointGrid(none, 0.1).nearest({0, 0, 0}, 1), std::nullopt);
  PointCloud one;
  one.push({0, 0, 0});
  EXPECT_FALSE(PointGrid(one, 0.1).visitBox(Eigen::AlignedBox3d(), [](std::uint32_t) { return true; }));
}

}  // namespace
}  // namespace boxgrasp
