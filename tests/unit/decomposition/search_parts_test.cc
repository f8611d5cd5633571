// The parts that the fast search is made of, each beside what it stands for.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "boxgrasp/decomposition/face_blocks.h"
#include "boxgrasp/decomposition/line_bounds.h"
#include "boxgrasp/decomposition/splits.h"
#include "boxgrasp/decomposition/z_order.h"
#include "shapes.h"

namespace boxgrasp {
namespace {

TEST(ZOrder, HasEveryPointOnce) {
  for (const auto& [name, cloud] : test::allShapes(1000)) {
    std::vector<std::uint32_t> order = zOrder(cloud);
    std::sort(order.begin(), order.end());
    ASSERT_EQ(order.size(), cloud.size()) << name;
    for (std::uint32_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], i) << name;
  }
}

double runLength(const PointCloud& cloud) {
  double length = 0.0;
  for (std::size_t i = 1; i < cloud.size(); ++i) length += (cloud.point(i) - cloud.point(i - 1)).norm();
  return length;
}

TEST(ZOrder, PutsNeighboursTogether) {
  const PointCloud cloud = test::brick(5000);
  EXPECT_LT(runLength(select(cloud, zOrder(cloud))), 0.3 * runLength(cloud));
}

TEST(ZOrder, TakesCloudsWithoutExtent) {
  PointCloud cloud;
  EXPECT_TRUE(zOrder(cloud).empty());
  for (int i = 0; i < 3; ++i) cloud.push({1, 2, 3});
  EXPECT_EQ(zOrder(cloud), (std::vector<std::uint32_t>{0, 1, 2}));
}

// Points of the upper half plane by rising angle, some of them on one ray.
std::vector<Vector2d> fanOf(std::size_t n, std::mt19937_64& random) {
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = uniform(random, 0.0, std::numbers::pi), radius = uniform(random, 0.1, 1.0);
    points.push_back(radius * Vector2d(std::cos(angle), std::sin(angle)));
    if (i % 4 == 0) points.push_back(points.back() * 0.5);
  }
  std::sort(points.begin(), points.end(),
            [](const Vector2d& a, const Vector2d& b) { return cross(a, b) > 0; });
  return points;
}

TEST(AreasOfGrowingHull, AreThoseOfTheHullsOfThePrefixes) {
  std::mt19937_64 random(11);
  for (int round = 0; round < 20; ++round) {
    const std::vector<Vector2d> points = fanOf(40, random);
    const std::vector<double> areas = areasOfGrowingHull(points);
    ASSERT_EQ(areas.size(), points.size() + 1);
    for (std::size_t k = 0; k <= points.size(); ++k) {
      const std::vector<Vector2d> prefix(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(k));
      EXPECT_NEAR(areas[k], signedArea(convexHull(prefix)), 1e-12) << k << " points";
    }
  }
}

// Random points on a face.
struct Scatter {
  explicit Scatter(std::size_t n, std::uint64_t seed = 12) {
    std::mt19937_64 random(seed);
    for (std::size_t i = 0; i < n; ++i) {
      x.push_back(static_cast<float>(0.1 * normal(random)));
      y.push_back(static_cast<float>(0.05 * normal(random)));
    }
  }
  FaceProjection face() const { return {0, 1.0, x, y}; }
  std::vector<float> x, y;
};

TEST(ThetaBounds, AreNeverAboveThetaAndNearItWithAllPoints) {
  const Scatter scatter(400);
  const FaceProjection face = scatter.face();
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i < face.size(); ++i) points.push_back(face.point(i));
  DecompositionOptions options;
  options.segment_fraction = 0.05;
  const CutLines cuts = cutLines(convexHull(points), options);
  ASSERT_FALSE(cuts.lines.empty());
  for (const std::size_t step : {1u, 7u}) {
    std::vector<Vector2d> few;
    for (std::size_t i = 0; i < points.size(); i += step) few.push_back(points[i]);
    std::vector<double> bounds(cuts.lines.size(), 0.0);
    raiseThetaBounds(
        face, few, cuts, [](double) { return true; }, bounds);
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      const double theta = plainTheta(face, cuts.lines[i].line);
      EXPECT_LE(bounds[i], theta);
      EXPECT_GT(bounds[i], theta - (step == 1 ? 0.02 : 1.0));
    }
  }
}

// Many points are on the lines, on the hull's edges and on one ray.
TEST(ThetaBounds, AreNeverAboveThetaOnALattice) {
  Scatter lattice(0);
  std::vector<Vector2d> points;
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 7; ++j) {
      lattice.x.push_back(0.1f * static_cast<float>(i)), lattice.y.push_back(0.1f * static_cast<float>(j));
      points.push_back(lattice.face().point(lattice.x.size() - 1));
    }
  }
  // A rectangle's edges in two runs each, so that lines along an edge are among the cuts.
  const Polygon hull{{0, 0}, {0.4, -1e-9}, {0.8, 0}, {0.8, 0.6}, {0.4, 0.6 + 1e-9}, {0, 0.6}};
  DecompositionOptions options;
  options.merge_angle_rad = 0.0;
  options.samples_per_segment = 9;
  const CutLines cuts = cutLines(hull, options);
  std::vector<double> bounds(cuts.lines.size(), 0.0);
  raiseThetaBounds(
      lattice.face(), points, cuts, [](double) { return true; }, bounds);
  for (std::size_t i = 0; i < bounds.size(); ++i)
    EXPECT_LE(bounds[i], plainTheta(lattice.face(), cuts.lines[i].line));
}

TEST(FaceBlocks, FindTheFarthestPoint) {
  for (const std::size_t n : {1u, 63u, 64u, 65u, 1000u}) {
    const Scatter scatter(n);
    const FaceBlocks blocks(scatter.face());
    for (int i = 0; i < 16; ++i) {
      const Vector2d direction(std::cos(0.4 * i), std::sin(0.4 * i));
      double farthest = -1e9;
      for (std::size_t k = 0; k < n; ++k)
        farthest = std::max(farthest, direction.dot(scatter.face().point(k)));
      const Vector2d found =
          blocks.support(static_cast<float>(direction.x()), static_cast<float>(direction.y()));
      EXPECT_NEAR(direction.dot(found), farthest, 1e-7);
    }
  }
}

// The half planes of a triangle around the origin.
Region triangle(float size) { return {{1, 0, size}, {-0.6f, 0.8f, size}, {-0.6f, -0.8f, size}}; }

double reachOut(const Vector2d& p, const Region& region) {
  double reach = -1e9;
  for (const HalfPlane& plane : region)
    reach = std::max(reach, plane.normal_x * p.x() + plane.normal_y * p.y() - plane.offset);
  return reach;
}

TEST(FaceBlocks, FindEveryPointOutsideOfBothRegions) {
  const Scatter scatter(3000);
  const FaceProjection face = scatter.face();
  const FaceBlocks blocks(face);
  const Region a = triangle(0.05f), b{{1, 0, -0.06f}};
  std::vector<Vector2d> found;
  blocks.appendOpenPoints(blocks.openBlocks(a, b), a, b, found);
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Vector2d p = face.point(i);
    const double reach = std::min(reachOut(p, a), reachOut(p, b));
    const bool is_found = std::find(found.begin(), found.end(), p) != found.end();
    EXPECT_TRUE(is_found || reach <= 0) << "point " << i << " is open";
    EXPECT_FALSE(is_found && reach < -1e-5) << "point " << i << " is inside";
  }
}

}  // namespace
}  // namespace boxgrasp
