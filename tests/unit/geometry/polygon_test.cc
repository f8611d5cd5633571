#include "boxgrasp/geometry/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "boxgrasp/base/random.h"

namespace boxgrasp {
namespace {

std::vector<Vector2d> randomPoints(std::size_t n, std::mt19937_64& random) {
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = uniform(random, -1, 1);
    points.emplace_back(x, uniform(random, -1, 1));
  }
  return points;
}

bool before(const Vector2d& a, const Vector2d& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); }

// A point is a hull vertex when some line through it has all others strictly on one side: when the directions
// to the others leave a gap of more than half a turn.
bool isVertexByBruteForce(const std::vector<Vector2d>& points, std::size_t i) {
  std::vector<double> angles;
  for (const Vector2d& p : points) {
    if (p != points[i]) angles.push_back(std::atan2(p.y() - points[i].y(), p.x() - points[i].x()));
  }
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + 2.0 * std::numbers::pi - angles.back();
  for (std::size_t k = 1; k < angles.size(); ++k) gap = std::max(gap, angles[k] - angles[k - 1]);
  return gap > std::numbers::pi + 1e-9;
}

Polygon moved(const Polygon& polygon, double angle, const Vector2d& shift) {
  Polygon result;
  for (const Vector2d& p : polygon) result.push_back(Eigen::Rotation2Dd(angle) * p + shift);
  return result;
}

TEST(ConvexHull, VerticesAreThoseOfBruteForce) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 300; ++round) {
    const auto points = randomPoints(3 + uniformIndex(random, 40), random);
    std::vector<Vector2d> expected;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (isVertexByBruteForce(points, i)) expected.push_back(points[i]);
    }
    Polygon hull = convexHull(points);
    EXPECT_GT(signedArea(hull), 0.0) << "expected counter-clockwise order";
    std::sort(hull.begin(), hull.end(), before);
    std::sort(expected.begin(), expected.end(), before);
    EXPECT_EQ(hull, expected);
  }
}

TEST(ConvexHull, LeavesOutCollinearAndRepeatedPoints) {
  std::vector<Vector2d> grid;
  for (int i = 0; i <= 10; ++i) {
    for (int j = 0; j <= 10; ++j) grid.insert(grid.end(), 2, Vector2d(0.1 * i, 0.7 + 0.1 * j));
  }
  EXPECT_EQ(convexHull(grid).size(), 4u);
  // Collinear but for the rounding of a rotation.
  std::mt19937_64 random(2);
  for (int round = 0; round < 50; ++round) {
    EXPECT_EQ(convexHull(moved(grid, uniform(random, 0, 6), {uniform(random), 3})).size(), 4u);
  }
}

// With the two ends it is the hull of the ends and of what is beyond the way between them.
TEST(HullBeyond, IsThePartOfTheHullBeyondTheWay) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 300; ++round) {
    const auto points = randomPoints(2 + uniformIndex(random, 60), random);
    const Vector2d a = points[0], b = points[1];
    std::vector<Vector2d> beyond{a, b};
    for (const Vector2d& p : points) {
      if (cross(b - a, p - a) < 0.0) beyond.push_back(p);
    }
    Polygon hull = hullBeyond(a, b, points);
    hull.insert(hull.begin(), a);
    hull.push_back(b);
    if (hull.size() > 2) {
      EXPECT_GT(signedArea(hull), 0.0) << "expected counter-clockwise order";
    }
    std::sort(hull.begin(), hull.end(), before);
    Polygon expected = convexHull(beyond);
    std::sort(expected.begin(), expected.end(), before);
    EXPECT_EQ(hull, expected);
  }
}

TEST(HullBeyond, LeavesOutTheEndsAndWhatIsOnTheWayOrBehindIt) {
  EXPECT_TRUE(hullBeyond({0, 0}, {1, 0}, {}).empty());
  EXPECT_TRUE(hullBeyond({0, 0}, {1, 0}, {{0, 0}, {0.3, 0}, {1, 0}, {2, 0}, {0.5, 1}}).empty());
  EXPECT_EQ(hullBeyond({0, 0}, {1, 0}, {{0.5, -1}, {0.5, -1}, {0.5, -0.9}}), (Polygon{{0.5, -1}}));
}

TEST(ConvexHull, DegenerateInputHasFewerThanThreeVertices) {
  EXPECT_TRUE(convexHull({}).empty());
  EXPECT_EQ(convexHull({{1, 2}, {1, 2}, {1, 2}}).size(), 1u);
  std::vector<Vector2d> line;
  for (int i = 0; i < 20; ++i) line.emplace_back(0.1 * i, 0.3 - 0.7 * i);
  const Polygon hull = convexHull(line);
  ASSERT_EQ(hull.size(), 2u);
  EXPECT_EQ(hull[0], line.front());
  EXPECT_EQ(hull[1], line.back());
}

TEST(Area, AndCentroidMoveWithThePolygon) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 100; ++round) {
    const Polygon polygon = convexHull(randomPoints(12, random));
    const double angle = uniform(random, 0, 6);
    const Vector2d shift(uniform(random, -9, 9), uniform(random, -9, 9));
    const Polygon other = moved(polygon, angle, shift);
    EXPECT_NEAR(signedArea(other), signedArea(polygon), 1e-13);
    EXPECT_LT((centroid(other) - (Eigen::Rotation2Dd(angle) * centroid(polygon) + shift)).norm(), 1e-13);
    EXPECT_EQ(signedArea(Polygon(polygon.rbegin(), polygon.rend())) < 0.0, signedArea(polygon) > 0.0);
  }
}

TEST(Area, ClosedForms) {
  EXPECT_DOUBLE_EQ(signedArea({{0, 0}, {4, 0}, {0, 3}}), 6.0);
  EXPECT_LT((centroid({{0, 0}, {3, 0}, {0, 3}}) - Vector2d(1, 1)).norm(), 1e-15);
  EXPECT_EQ(signedArea({{0, 0}, {4, 0}}), 0.0);
  EXPECT_LT((centroid({{0, 0}, {4, 2}}) - Vector2d(2, 1)).norm(), 1e-15)
      << "expected the mean of the vertices";
  EXPECT_EQ(centroid({{5, 7}}), Vector2d(5, 7));
}

// The area centroid is additive over a cut: the parts' centroids weighted by area give the whole's.
TEST(Clip, TheTwoHalvesMakeTheWhole) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 300; ++round) {
    const Polygon polygon = convexHull(randomPoints(10, random));
    const Vector2d point(uniform(random, -1, 1), uniform(random, -1, 1)),
        normal_(uniform(random, -1, 1), 0.3);
    const Polygon a = clip(polygon, point, normal_), b = clip(polygon, point, -normal_);
    EXPECT_NEAR(signedArea(a) + signedArea(b), signedArea(polygon), 1e-13);
    Vector2d weighted = Vector2d::Zero();
    for (const Polygon* part : {&a, &b}) {
      if (!part->empty()) weighted += signedArea(*part) * centroid(*part);
    }
    EXPECT_LT((weighted - signedArea(polygon) * centroid(polygon)).norm(), 1e-12);
  }
}

TEST(Clip, AgreesWithMonteCarlo) {
  std::mt19937_64 random(5);
  const Polygon polygon = convexHull(randomPoints(8, random));
  Polygon clipped = polygon;
  const Vector2d points[] = {{0.1, 0.2}, {-0.3, 0}}, normals[] = {{1, 0.5}, {-0.2, 1}};
  for (int i = 0; i < 2; ++i) clipped = clip(clipped, points[i], normals[i]);
  const int n = 200000;
  int hits = 0;
  for (const Vector2d& p : randomPoints(n, random)) {
    const bool inside =
        containsPoint(polygon, p) && normals[0].dot(p - points[0]) >= 0 && normals[1].dot(p - points[1]) >= 0;
    EXPECT_EQ(containsPoint(clipped, p), inside);
    hits += inside;
  }
  const double share = signedArea(clipped) / 4.0;
  EXPECT_NEAR(static_cast<double>(hits) / n, share, 5.0 * std::sqrt(share / n));
}

TEST(Clip, KeepsAllOrNothing) {
  const Polygon square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_EQ(clip(square, {0, -1}, {0, 1}), square);
  EXPECT_TRUE(clip(square, {0, 2}, {0, 1}).empty());
  EXPECT_TRUE(clip({}, {0, 0}, {0, 1}).empty());
}

TEST(ContainsPoint, EdgeCountsAndDegeneratePolygonsContainNothing) {
  const Polygon square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_TRUE(containsPoint(square, {0.5, 0}));
  EXPECT_TRUE(containsPoint(square, {1, 1}));
  EXPECT_FALSE(containsPoint(square, {1.001, 0.5}));
  EXPECT_FALSE(containsPoint({{0, 0}, {1, 0}}, {0.5, 0}));
}

double smallestAreaByBruteForce(const Polygon& hull) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vector2d axis = (hull[(i + 1) % hull.size()] - hull[i]).normalized(), normal_(-axis.y(), axis.x());
    Vector2d low = Vector2d::Constant(1e9), high = -low;
    for (const Vector2d& p : hull) {
      low = low.cwiseMin(Vector2d(axis.dot(p), normal_.dot(p)));
      high = high.cwiseMax(Vector2d(axis.dot(p), normal_.dot(p)));
    }
    best = std::min(best, (high - low).prod());
  }
  return best;
}

TEST(MinAreaRectangle, AgreesWithBruteForceAndContainsTheHull) {
  std::mt19937_64 random(6);
  for (int round = 0; round < 1000; ++round) {
    const Polygon hull = convexHull(randomPoints(3 + uniformIndex(random, 60), random));
    const Rectangle rectangle = minAreaRectangle(hull);
    EXPECT_NEAR(rectangle.area(), smallestAreaByBruteForce(hull), 1e-12);
    EXPECT_NEAR(rectangle.axis.norm(), 1.0, 1e-14);
    for (const Vector2d& p : hull) {
      const Vector2d offset = p - rectangle.center;
      EXPECT_LE(std::abs(rectangle.axis.dot(offset)), 0.5 * rectangle.length + 1e-12);
      EXPECT_LE(std::abs(cross(rectangle.axis, offset)), 0.5 * rectangle.width + 1e-12);
    }
  }
}

TEST(MinAreaRectangle, MovesWithTheHull) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 100; ++round) {
    const Polygon hull = convexHull(randomPoints(15, random));
    const Rectangle other = minAreaRectangle(moved(hull, uniform(random, 0, 6), {3, -4}));
    EXPECT_NEAR(other.area(), minAreaRectangle(hull).area(), 1e-12);
  }
}

TEST(MinAreaRectangle, OfAPointAndASegment) {
  const Rectangle point = minAreaRectangle({{2, 3}});
  EXPECT_EQ(point.center, Vector2d(2, 3));
  EXPECT_EQ(point.area(), 0.0);
  const Rectangle segment = minAreaRectangle({{0, 0}, {3, 4}});
  EXPECT_DOUBLE_EQ(segment.length, 5.0);
  EXPECT_EQ(segment.width, 0.0);
  EXPECT_LT((segment.axis - Vector2d(0.6, 0.8)).norm(), 1e-15);
}

}  // namespace
}  // namespace boxgrasp
