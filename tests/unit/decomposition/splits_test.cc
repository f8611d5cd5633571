#include "boxgrasp/decomposition/splits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "boxgrasp/decomposition/cut_lines.h"
#include "boxgrasp/geometry/min_volume_box.h"
#include "shapes.h"

namespace boxgrasp {
namespace {

// A cloud seen from its box, with its three faces.
struct Projected {
  explicit Projected(const PointCloud& cloud_C)
      : box(minVolumeBox(cloud_C)), cloud_B(transformed(cloud_C, box.X_CB.inverse())) {
    for (int axis = 0; axis < 3; ++axis) faces[axis] = projectionAlong(axis, box, cloud_B);
  }
  Projected(const Projected&) = delete;  // faces look into cloud_B

  OrientedBox box;
  PointCloud cloud_B;
  FaceProjections faces;
};

std::vector<Line> linesOn(const Polygon& hull, const DecompositionOptions& options = {}) {
  std::vector<Line> lines;
  for (const CutLine& cut : cutLines(hull, options).lines) lines.push_back(cut.line);
  return lines;
}

Vector2d normalOf(const Line& line) { return {line.normal_x, line.normal_y}; }

bool isFirst(const Line& line, const Vector2d& p) {
  return line.isFirst(static_cast<float>(p.x()), static_cast<float>(p.y()));
}

std::vector<Vector2d> pointsOf(const FaceProjection& face) {
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i < face.size(); ++i) points.push_back(face.point(i));
  return points;
}

Polygon regularPolygon(int corners, double radius) {
  Polygon polygon;
  for (int i = 0; i < corners; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / corners;
    polygon.push_back(radius * Vector2d(std::cos(turn), std::sin(turn)));
  }
  return polygon;
}

const Polygon kRectangle{{0, 0}, {3, 0}, {3, 1}, {0, 1}};

// A rectangle whose edges noise has broken into many short ones.
Polygon brokenRectangle() {
  Polygon polygon;
  const Polygon corners = kRectangle;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector2d edge = corners[(k + 1) % 4] - corners[k], outward(edge.y(), -edge.x());
    for (int i = 0; i < 10; ++i) {
      const double t = 0.1 * i;
      polygon.push_back(corners[k] + t * edge + 0.02 * t * (1 - t) * outward);
    }
  }
  return polygon;
}

double lengthOf(const std::vector<Vector2d>& polyline) {
  double length = 0.0;
  for (std::size_t i = 1; i < polyline.size(); ++i) length += (polyline[i] - polyline[i - 1]).norm();
  return length;
}

double perimeterOf(Polygon polygon) {
  polygon.push_back(polygon.front());
  return lengthOf(polygon);
}

std::vector<Polygon> hullsOf(const std::vector<test::NamedCloud>& shapes) {
  std::vector<Polygon> hulls;
  for (const auto& [name, cloud] : shapes) {
    const Projected projected(cloud);
    for (const FaceProjection& face : projected.faces) hulls.push_back(convexHull(pointsOf(face)));
  }
  return hulls;
}

TEST(LongSegments, AreTheEdgesOfARectangle) {
  EXPECT_EQ(longSegments(kRectangle, {}).size(), 4u);
  EXPECT_EQ(longSegments(brokenRectangle(), {}).size(), 4u) << "runs of nearly straight edges count as one";
  DecompositionOptions options;
  options.segment_fraction = 0.2;  // the short sides have 1 / 8 of the perimeter
  EXPECT_EQ(longSegments(kRectangle, options).size(), 2u);
}

TEST(LongSegments, AreNotFoundOnADisc) {
  EXPECT_TRUE(longSegments(regularPolygon(64, 0.05), {}).empty());
  EXPECT_TRUE(linesOn(regularPolygon(64, 0.05)).empty());
}

TEST(LongSegments, AreNotFoundOnFewerThanThreeVertices) {
  for (const Polygon& hull : {Polygon{}, Polygon{{0, 0}}, Polygon{{0, 0}, {1, 0}}}) {
    EXPECT_TRUE(longSegments(hull, {}).empty());
    EXPECT_TRUE(linesOn(hull).empty());
  }
}

TEST(LongSegments, AreLongerThanTheThresholdAndTurnLittle) {
  const DecompositionOptions options;
  for (const Polygon& hull : hullsOf(test::allShapes(1000))) {
    for (const auto& segment : longSegments(hull, options)) {
      EXPECT_GT(lengthOf(segment), options.segment_fraction * perimeterOf(hull));
      const Vector2d first = segment[1] - segment[0], last = segment.back() - segment[segment.size() - 2];
      EXPECT_LT(std::atan2(cross(first, last), first.dot(last)), options.merge_angle_rad + 1e-12);
      for (const Vector2d& p : segment) EXPECT_NE(std::find(hull.begin(), hull.end(), p), hull.end());
    }
  }
}

TEST(LongSegments, DoNotDependOnTheFirstVertex) {
  const auto byFirstPoint = [](const auto& a, const auto& b) {
    return std::lexicographical_compare(a[0].begin(), a[0].end(), b[0].begin(), b[0].end());
  };
  for (Polygon hull : hullsOf(test::allShapes(500))) {
    auto expected = longSegments(hull, {});
    std::sort(expected.begin(), expected.end(), byFirstPoint);
    for (int turn = 0; turn < 5; ++turn) {
      std::rotate(hull.begin(), hull.begin() + 1, hull.end());
      auto segments = longSegments(hull, {});
      std::sort(segments.begin(), segments.end(), byFirstPoint);
      EXPECT_EQ(segments, expected);
    }
  }
}

TEST(CutLines, JoinEverySampleOfEveryPairOfSegments) {
  DecompositionOptions options;
  options.samples_per_segment = 5;
  EXPECT_EQ(linesOn(kRectangle, options).size(), 6u * 5u * 5u);
}

// A line through an interior sample of two edges has hull vertices strictly on both sides.
TEST(CutLines, PartTheHull) {
  for (const Polygon& hull : hullsOf(test::allShapes(500))) {
    for (const Line& line : linesOn(hull)) {
      EXPECT_NEAR(normalOf(line).norm(), 1.0, 1e-6);
      const auto before = [&](const Vector2d& p) { return isFirst(line, p); };
      EXPECT_TRUE(std::any_of(hull.begin(), hull.end(), before));
      EXPECT_FALSE(std::all_of(hull.begin(), hull.end(), before));
    }
  }
}

// Eq. 1, written down anew.
double thetaOf(const FaceProjection& face, const Line& line) {
  std::vector<Vector2d> p1, p2;
  for (const Vector2d& p : pointsOf(face)) (isFirst(line, p) ? p1 : p2).push_back(p);
  return (signedArea(convexHull(p1)) + signedArea(convexHull(p2))) / face.area;
}

std::size_t fewerSide(const FaceProjection& face, const Line& line) {
  const std::vector<Vector2d> points = pointsOf(face);
  const auto first = static_cast<std::size_t>(
      std::count_if(points.begin(), points.end(), [&](const Vector2d& p) { return isFirst(line, p); }));
  EXPECT_EQ(countFirst(face, line), first);
  return std::min(first, points.size() - first);
}

TEST(BestHullLine, HasTheLeastThetaOfAllLines) {
  DecompositionOptions options;
  options.gain_t = 1.0;
  for (const auto& [name, cloud] : test::allShapes(800)) {
    SCOPED_TRACE(name);
    const Projected projected(cloud);
    const std::size_t least = leastPoints(cloud.size(), options.min_point_fraction);
    double smallest = options.gain_t;
    for (const FaceProjection& face : projected.faces) {
      for (const Line& line : linesOn(convexHull(pointsOf(face)))) {
        const double theta = thetaOf(face, line);
        EXPECT_EQ(theta, plainTheta(face, line));
        if (fewerSide(face, line) >= least) smallest = std::min(smallest, theta);
      }
    }
    const std::optional<BestLine> best = bestHullLine(projected.faces, options, {});
    ASSERT_EQ(best.has_value(), smallest < options.gain_t);
    if (!best) continue;
    EXPECT_NEAR(best->theta, smallest, 1e-9);
    EXPECT_NEAR(thetaOf(projected.faces[best->face], best->line), smallest, 1e-9);
  }
}

TEST(PlainTheta, LeavesOutTheStripBetweenTheSides) {
  const std::vector<float> x{0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1}, y{0, 1, 0, 1, 0, 1, 0, 1, 0, 1};
  const FaceProjection face{0, 1.0, x, y};
  EXPECT_NEAR(plainTheta(face, {1, 0, 0.4f}), 0.75, 1e-12) << "all but the strip between the points";
  EXPECT_EQ(countFirst(face, {1, 0, 0.4f}), 4u);
}

// Alg. II.2, written down anew: for every position x, the bounding rectangles of both sides.
double boundTheta(const FaceProjection& face, int direction, double offset, std::size_t least) {
  Eigen::AlignedBox2d first, second;
  std::size_t on_first = 0;
  for (const Vector2d& p : pointsOf(face)) {
    const bool is_first = p[direction] <= offset;
    (is_first ? first : second).extend(p);
    on_first += is_first;
  }
  if (on_first < least || face.size() - on_first < least) return std::numeric_limits<double>::infinity();
  return (first.volume() + second.volume()) / face.area;
}

double leastBoundTheta(const FaceProjections& faces, double step, std::size_t least) {
  double best = std::numeric_limits<double>::infinity();
  for (const FaceProjection& face : faces) {
    for (const int direction : {0, 1}) {
      const std::span<const float> along = direction == 0 ? face.x : face.y;
      const auto [low, high] = std::minmax_element(along.begin(), along.end());
      const double start = *low;
      for (int k = 0; start + k * step < *high; ++k)
        best = std::min(best, boundTheta(face, direction, start + k * step, least));
    }
  }
  return best;
}

TEST(BestBoundLine, HasTheLeastSumOfBoundingRectangles) {
  for (const auto& [name, cloud] : test::allShapes(400)) {
    SCOPED_TRACE(name);
    const Projected projected(cloud);
    const FaceProjections& faces = projected.faces;
    const DecompositionOptions options;
    const std::size_t least = leastPoints(cloud.size(), options.min_point_fraction);
    const std::optional<BestLine> best = bestBoundLine(faces, options);
    ASSERT_TRUE(best.has_value());
    EXPECT_NEAR(best->theta, leastBoundTheta(faces, options.bound_step_m, least), 1e-9);
    const int direction = best->line.normal_x == 1.0f ? 0 : 1;
    EXPECT_EQ(normalOf(best->line), Vector2d::Unit(direction)) << "the line is parallel to an edge";
    EXPECT_NEAR(best->theta, boundTheta(faces[best->face], direction, best->line.offset, least), 1e-9);
  }
}

// Paper II.1: bounding rectangles hardly shrink wherever a U is cut parallel to its edges, convex hulls do.
// Whether the cut is made rests with Alg. II.1's volume test as well, which halves of a U that are L's as
// tall as the U do not pass.
TEST(Splits, OnlyTheHullRuleSeesTheHollowOfAU) {
  const Projected projected(test::letterU(4000));
  EXPECT_GT(bestBoundLine(projected.faces, {})->theta, 0.95);
  EXPECT_LT(bestHullLine(projected.faces, {}, {})->theta, 0.8);
}

TEST(Splits, NeedEnoughPointsOnBothSides) {
  const Projected projected(test::letterL(200));
  DecompositionOptions options;
  options.min_point_fraction = 0.49;
  for (const auto& best :
       {bestHullLine(projected.faces, options, {}), bestBoundLine(projected.faces, options)}) {
    if (!best) continue;
    EXPECT_GE(fewerSide(projected.faces[best->face], best->line), 98u);
  }
}

TEST(LeastPoints, RoundsUpAndIsNeverZero) {
  EXPECT_EQ(leastPoints(1000, 0.02), 20u);
  EXPECT_EQ(leastPoints(1001, 0.02), 21u);
  EXPECT_EQ(leastPoints(10, 0.0), 1u);
}

TEST(CutAlong, PartsSpaceAsItsLinePartsTheFace) {
  const PointCloud cloud = test::mug(500);
  const Projected projected(cloud);
  const Line line{0.6f, 0.8f, 0.003f};
  for (int axis = 0; axis < 3; ++axis) {
    const Cut cut = cutAlong(line, axis, projected.box);
    EXPECT_EQ(cut.axis, axis);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const double beyond = cut.normal_C.dot(cloud.point(i)) - cut.offset_m;
      const FaceProjection& face = projected.faces[axis];
      if (std::abs(beyond) < 1e-7) continue;
      EXPECT_EQ(line.isFirst(face.x[i], face.y[i]), beyond < 0);
    }
  }
}

}  // namespace
}  // namespace boxgrasp
