#include "boxgrasp/decomposition/angular_sweep.h"

#include <gtest/gtest.h>

#include "boxgrasp/base/random.h"

namespace boxgrasp {
namespace {

double hullAreas(const std::vector<Vector2d>& points, const Vector2d& apex, const Vector2d& direction) {
  std::vector<Vector2d> left, right;
  for (const Vector2d& p : points) (cross(direction, p - apex) > 0 ? left : right).push_back(p);
  return signedArea(convexHull(left)) + signedArea(convexHull(right));
}

std::vector<Vector2d> randomPoints(std::mt19937_64& random, std::size_t n) {
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = normal(random);
    points.push_back({0.1 * x, 0.05 * normal(random)});
  }
  return points;
}

TEST(AngularSweep, GivesTheHullAreasOfBothSidesOfEveryLine) {
  std::mt19937_64 random(1);
  AngularSweep sweep;
  for (const std::size_t n : {3, 4, 10, 100, 500}) {
    const std::vector<Vector2d> points = randomPoints(random, n);
    const Polygon hull = convexHull(points);
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Vector2d& a = hull[i];
      const Vector2d& b = hull[(i + 1) % hull.size()];
      const Vector2d apex = a + uniform(random, 0.1, 0.9) * (b - a), inside = centroid(hull);
      sweep.sweep(points, apex, inside);
      for (int k = 0; k < 20; ++k) {
        const Vector2d target = points[uniformIndex(random, n)];
        const Vector2d direction = target + uniform(random, 0.1, 0.9) * (inside - target) - apex;
        EXPECT_NEAR(sweep.area(direction), hullAreas(points, apex, direction), 1e-12);
      }
    }
  }
}

// Many points are on the line, on its rays and on the hull's edges.
TEST(AngularSweep, NeverGivesMoreThanTheHullAreasOnALattice) {
  std::vector<Vector2d> points;
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) points.push_back(Vector2d(i, j) * 0.1);
  }
  AngularSweep sweep;
  for (const Vector2d& apex :
       {Vector2d(0.0, 0.0), Vector2d(0.4, 0.0), Vector2d(0.25, 0.0), Vector2d(0.8, 0.3)}) {
    sweep.sweep(points, apex, {0.4, 0.4});
    for (const Vector2d& target : points) {
      if (target == apex) continue;
      const Vector2d direction = target - apex;
      EXPECT_LE(sweep.area(direction), hullAreas(points, apex, direction) + 1e-12);
      const Vector2d beside = direction + 0.0123 * (Vector2d(0.41, 0.37) - target);
      EXPECT_GT(sweep.area(beside), 0.8 * hullAreas(points, apex, beside)) << "bounds that are close";
    }
  }
}

TEST(AngularSweep, TakesPointsThatCoincideAndNone) {
  AngularSweep sweep;
  sweep.sweep({}, {0, 0}, {0, 1});
  EXPECT_EQ(sweep.area({0, 1}), 0.0);
  sweep.sweep({{0, 0}, {0, 0}, {0, 1}, {0, 1}}, {0, 0}, {0, 1});
  EXPECT_EQ(sweep.area({1, 1}), 0.0);
}

}  // namespace
}  // namespace boxgrasp
