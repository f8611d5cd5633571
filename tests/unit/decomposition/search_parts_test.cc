// The parts that the fast search is made of, each beside what it stands for.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <numeric>

#include "boxgrasp/decomposition/face_blocks.h"
#include "boxgrasp/decomposition/line_bounds.h"
#include "boxgrasp/decomposition/point_pool.h"
#include "boxgrasp/decomposition/sides.h"
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

// The place of a cell on the curve, a bit at a time.
std::uint32_t placeOnCurve(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  std::uint32_t place = 0;
  for (int bit = 4; bit >= 0; --bit)
    place = place << 3 | (x >> bit & 1u) << 2 | (y >> bit & 1u) << 1 | (z >> bit & 1u);
  return place;
}

TEST(ZOrder, FollowsTheCurveThroughTheCells) {
  std::mt19937_64 random(8);
  PointCloud cloud;
  cloud.push({0, 0, 0});
  cloud.push({1, 1, 1});
  std::vector<std::uint32_t> places{0, placeOnCurve(31, 31, 31)};
  const auto cell = [&] { return static_cast<std::uint32_t>(uniformIndex(random, 32)); };
  for (int i = 0; i < 2000; ++i) {
    const std::uint32_t x = cell(), y = cell(), z = cell();
    cloud.push(Vector3d(x + 0.5, y + 0.5, z + 0.5) / 32.0);
    places.push_back(placeOnCurve(x, y, z));
  }
  std::vector<std::uint32_t> expected(cloud.size());
  std::iota(expected.begin(), expected.end(), 0u);
  std::ranges::stable_sort(expected, {}, [&](std::uint32_t i) { return places[i]; });
  EXPECT_EQ(zOrder(cloud), expected);
}

TEST(ZOrder, TakesCloudsWithoutExtent) {
  PointCloud cloud;
  EXPECT_TRUE(zOrder(cloud).empty());
  for (int i = 0; i < 3; ++i) cloud.push({1, 2, 3});
  EXPECT_EQ(zOrder(cloud), (std::vector<std::uint32_t>{0, 1, 2}));
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

double reachOut(const Vector2d& p, const Region& region) {
  double reach = -1e9;
  for (const HalfPlane& plane : region)
    reach = std::max(reach, plane.normal_x * p.x() + plane.normal_y * p.y() - plane.offset);
  return reach;
}

std::vector<Vector2d> pointsOf(const FaceProjection& face) {
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i < face.size(); ++i) points.push_back(face.point(i));
  return points;
}

TEST(HullArcs, HaveTheAreaOfTheirVertices) {
  const HullArcs arcs(convexHull(pointsOf(Scatter(200).face())));
  const std::size_t n = arcs.hull().size();
  for (std::size_t first = 0; first < n; ++first) {
    Polygon arc;
    for (std::size_t count = 1, last = first; count <= n; ++count, last = arcs.next(last)) {
      arc.push_back(arcs.at(last));
      EXPECT_NEAR(arcs.area({first, last}), signedArea(arc), 1e-12) << first << " to " << last;
    }
    EXPECT_EQ(arcs.next(arcs.previous(first)), first);
  }
}

DecompositionOptions manyLines() {
  DecompositionOptions options;
  options.segment_fraction = 0.05;
  return options;
}

TEST(CutLines, KnowTheirPlaces) {
  const CutLines cuts = cutLines(convexHull(pointsOf(Scatter(400).face())), manyLines());
  ASSERT_GT(cuts.segments(), 2u);
  for (std::size_t i = 0; i < cuts.lines.size(); ++i)
    EXPECT_EQ(cuts.index(cuts.lines[i].from, cuts.lines[i].to), i);
}

TEST(CutLines, HaveSamplesOnTheEdgesThatTheyName) {
  const Polygon hull = convexHull(pointsOf(Scatter(400).face()));
  for (const Sample& sample : cutLines(hull, manyLines()).samples) {
    const Vector2d &a = hull[sample.before], &b = hull[(sample.before + 1) % hull.size()];
    EXPECT_NEAR((sample.point - a).norm() + (b - sample.point).norm(), (b - a).norm(), 1e-12);
  }
}

// Halves a block until it is lines; calls visit(block) with each on the way.
template <typename Visit>
void halve(const LineBlock& block, const Visit& visit) {
  visit(block);
  if (block.size() == 1) return;
  for (const LineBlock& half : halvesOf(block)) halve(half, visit);
}

TEST(LineBlocks, HaveEveryLineOnce) {
  const CutLines cuts = cutLines(convexHull(pointsOf(Scatter(400).face())), manyLines());
  std::vector<int> seen(cuts.lines.size(), 0);
  for (const LineBlock& block : blocksOf(cuts)) {
    halve(block, [&](const LineBlock& part) {
      if (part.size() == 1) ++seen[cuts.index(part.first_from, part.first_to)];
    });
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(seen.size()));
}

// Bounds every block of lines on the face, and compares with each line's own Theta.
void expectLowerBounds(const FaceProjection& face, const CutLines& cuts, const HullArcs& arcs,
                       const std::vector<Vector2d>& known, int depth) {
  const ThetaBounds bounds(arcs, cuts, face.area, known);
  std::vector<double> theta;
  for (const CutLine& cut : cuts.lines) theta.push_back(plainTheta(face, cut.line));
  for (const LineBlock& whole : blocksOf(cuts)) {
    halve(whole, [&](const LineBlock& block) {
      const double bound = bounds.of(block, depth);
      for (std::size_t from = block.first_from; from <= block.last_from; ++from) {
        for (std::size_t to = block.first_to; to <= block.last_to; ++to)
          ASSERT_LE(bound, theta[cuts.index(from, to)])
              << "from " << from << " to " << to << ", depth " << depth;
      }
      if (block.size() == 1 && depth > 5 && known.size() == face.size()) {
        const double own = theta[cuts.index(block.first_from, block.first_to)];
        EXPECT_GT(bound, 0.98 * own) << "all points are known, and deep hulls are nearly whole";
      }
    });
  }
}

TEST(ThetaBounds, AreNeverAboveThetaAndNearItWithAllPoints) {
  for (const std::uint64_t seed : {12u, 13u, 14u}) {
    const Scatter scatter(400, seed);
    const std::vector<Vector2d> points = pointsOf(scatter.face());
    const HullArcs arcs(convexHull(points));
    const CutLines cuts = cutLines(arcs.hull(), manyLines());
    ASSERT_FALSE(cuts.lines.empty());
    for (const std::size_t step : {1u, 7u}) {
      std::vector<Vector2d> few;
      for (std::size_t i = 0; i < points.size(); i += step) few.push_back(points[i]);
      for (const int depth : {1, 2, 4, 12}) expectLowerBounds(scatter.face(), cuts, arcs, few, depth);
    }
  }
}

// Many points are on the lines, on the hull's edges and in one place.
TEST(ThetaBounds, AreNeverAboveThetaOnALattice) {
  Scatter lattice(0);
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 7; ++j) {
      for (int twice = 0; twice < 2; ++twice)
        lattice.x.push_back(0.1f * static_cast<float>(i)), lattice.y.push_back(0.1f * static_cast<float>(j));
    }
  }
  const FaceProjection face = lattice.face();
  const HullArcs arcs(convexHull(pointsOf(face)));
  for (const int samples : {3, 8, 9}) {  // of 8 on the longer edges, every line goes through lattice points
    DecompositionOptions options;
    options.samples_per_segment = samples;
    const CutLines cuts = cutLines(arcs.hull(), options);
    ASSERT_EQ(cuts.segments(), 4u);
    for (const int depth : {1, 2, 3, 5}) expectLowerBounds(face, cuts, arcs, pointsOf(face), depth);
  }
}

TEST(Sides, HaveThePlainThetaWithAllPoints) {
  const Scatter scatter(300);
  const FaceProjection face = scatter.face();
  const std::vector<Vector2d> points = pointsOf(face);
  const HullArcs arcs(convexHull(points));
  const CutLines cuts = cutLines(arcs.hull(), manyLines());
  ASSERT_FALSE(cuts.lines.empty());
  for (const CutLine& cut : cuts.lines) {
    std::optional<Sides> sides = Sides::of(arcs, cut.line);
    ASSERT_TRUE(sides.has_value());
    double before = sides->area();
    for (std::size_t begin = 0; begin < points.size(); begin += 100) {
      sides->add({points.begin() + static_cast<std::ptrdiff_t>(begin),
                  points.begin() + static_cast<std::ptrdiff_t>(begin + 100)});
      EXPECT_GE(sides->area(), before - 1e-12) << "hulls only grow";
      before = sides->area();
    }
    EXPECT_NEAR(sides->area() / face.area, plainTheta(face, cut.line), 1e-12);
  }
}

// Whether adding the point would make the hulls grow is what their insides say.
TEST(Sides, GrowByPointsOutsideOfTheirInsidesAlone) {
  const Scatter scatter(300);
  const std::vector<Vector2d> points = pointsOf(scatter.face());
  const HullArcs arcs(convexHull(points));
  const CutLines cuts = cutLines(arcs.hull(), manyLines());
  const std::vector<Vector2d> some(points.begin(), points.begin() + 60);
  for (std::size_t i = 0; i < cuts.lines.size(); i += 5) {
    std::optional<Sides> sides = Sides::of(arcs, cuts.lines[i].line);
    ASSERT_TRUE(sides.has_value());
    sides->add(some);
    const Region first = sides->first().inside(), second = sides->second().inside();
    const auto isWithoutInside = [](const HalfPlane& plane) {
      return plane.normal_x == 0.0f && plane.normal_y == 0.0f;
    };
    const bool have_area = std::none_of(first.begin(), first.end(), isWithoutInside) &&
                           std::none_of(second.begin(), second.end(), isWithoutInside);
    for (const Vector2d& p : points) {
      Sides grown = *sides;
      grown.add({p});
      const double reach = std::min(reachOut(p, first), reachOut(p, second));
      if (reach < -1e-6) {
        EXPECT_NEAR(grown.area(), sides->area(), 1e-12) << "line " << i;
      } else if (reach > 1e-6 && have_area) {
        EXPECT_GT(grown.area(), sides->area()) << "line " << i;
      }
    }
  }
}

// The arc of the first side is one vertex: there is no chord to look beyond.
TEST(Sides, GrowFromASingleVertex) {
  const HullArcs arcs({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  const Line line{-std::numbers::sqrt2_v<float> / 2, -std::numbers::sqrt2_v<float> / 2,
                  -0.9f * std::numbers::sqrt2_v<float>};  // x + y >= 1.8
  std::optional<Sides> sides = Sides::of(arcs, line);
  ASSERT_TRUE(sides.has_value());
  const double before = sides->area();
  sides->add({{1, 1}});
  EXPECT_EQ(sides->area(), before) << "the vertex itself";
  sides->add({{0.9, 0.95}});
  EXPECT_EQ(sides->area(), before) << "a segment has no area";
  sides->add({{0.95, 0.9}});
  EXPECT_NEAR(sides->area(), before + 0.5 * std::abs(0.1 * 0.1 - 0.05 * 0.05), 1e-12) << "a triangle";
  sides->add({{0.95, 0.93}, {0.3, 0.3}});
  EXPECT_NEAR(sides->area(), before + 0.5 * std::abs(0.1 * 0.1 - 0.05 * 0.05), 1e-12)
      << "points inside the triangle and inside the other side";
}

TEST(Sides, AreNotThereForLinesThatDoNotPartTheHull) {
  const HullArcs arcs({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  EXPECT_FALSE(Sides::of(arcs, {1, 0, 2}).has_value());
  EXPECT_FALSE(Sides::of(arcs, {1, 0, -1}).has_value());
  ASSERT_TRUE(Sides::of(arcs, {1, 0, 0.5f}).has_value());
  EXPECT_EQ(Sides::of(arcs, {1, 0, 0.5f})->area(), 0.0) << "an edge on either side";
}

TEST(FaceBlocks, FindTheFarthestPoint) {
  for (const std::size_t n : {1u, 63u, 64u, 65u, 1000u}) {
    const Scatter scatter(n);
    const BlockedValues x(scatter.x), y(scatter.y);
    const FaceBlocks blocks(x, y);
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

TEST(FaceBlocks, FindEveryPointOutsideOfBothRegions) {
  const Scatter scatter(3000);
  const FaceProjection face = scatter.face();
  const BlockedValues x(scatter.x), y(scatter.y);
  const FaceBlocks blocks(x, y);
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

TEST(FaceBlocks, FindEveryPointOutsideOfAHalfPlane) {
  const Scatter scatter(3000);
  const FaceProjection face = scatter.face();
  const BlockedValues x(scatter.x), y(scatter.y);
  const FaceBlocks blocks(x, y);
  for (const float offset : {-1.0f, 0.0f, 0.1f, 1.0f}) {
    const HalfPlane plane{0.6f, 0.8f, offset};
    const std::vector<Vector2d> found = blocks.pointsOutside(plane);
    for (std::size_t i = 0; i < face.size(); ++i) {
      const double reach = reachOut(face.point(i), {plane});
      const bool is_found = std::find(found.begin(), found.end(), face.point(i)) != found.end();
      EXPECT_TRUE(is_found || reach <= 0) << "point " << i << " is outside of " << offset;
      EXPECT_FALSE(is_found && reach < -1e-5) << "point " << i << " is inside of " << offset;
    }
  }
}

TEST(PointPool, FindsEveryOpenPoint) {
  const Scatter scatter(200);
  const Region a = triangle(0.05f), b{{1, 0, -0.06f}};
  PointPool pool;
  for (std::size_t n = 0; n < 200; ++n) {
    std::vector<Vector2d> found;
    pool.appendOpenPoints(a, b, 1e-6f, found);
    EXPECT_LE(found.size(), n) << "none twice";
    for (std::size_t i = 0; i < n; ++i) {
      const Vector2d p = scatter.face().point(i);
      const double reach = std::min(reachOut(p, a), reachOut(p, b));
      const bool is_found = std::find(found.begin(), found.end(), p) != found.end();
      EXPECT_TRUE(is_found || reach <= 0) << "point " << i << " of " << n << " is open";
      EXPECT_FALSE(is_found && reach < -1e-5) << "point " << i << " of " << n << " is inside";
    }
    pool.add(scatter.face().point(n));
  }
}

TEST(PointPool, FindsTheFarthestPointOnASide) {
  for (const std::size_t n : {0u, 1u, 64u, 65u, 512u, 513u, 1300u}) {
    const std::vector<Vector2d> points = pointsOf(Scatter(n).face());
    const PointPool pool(points);
    for (int i = 0; i < 16; ++i) {
      const Region beyond{{std::cos(0.4f * i), std::sin(0.4f * i), 0.02f}}, side{{0.8f, -0.6f, 0.03f}};
      double farthest = 0.0;
      for (const Vector2d& p : points) {
        if (reachOut(p, side) <= 0) farthest = std::max(farthest, reachOut(p, beyond));
      }
      const std::optional<Vector2d> found = pool.farthestBeyond(beyond[0], side[0]);
      ASSERT_EQ(found.has_value(), farthest > 0.0) << n << " points, direction " << i;
      if (found) {
        EXPECT_LE(reachOut(*found, side), 1e-7) << n << " points, direction " << i;
        EXPECT_NEAR(reachOut(*found, beyond), farthest, 1e-7) << n << " points, direction " << i;
      }
    }
  }
}

// Beyond the way between two vertices of a hull there is the hull's area on that side of it.
TEST(PoolGrowth, GainsTheAreaOfTheHull) {
  const std::vector<Vector2d> points = pointsOf(Scatter(600).face());
  const PointPool pool(points);
  const Polygon hull = convexHull(points);
  const HalfPlane everywhere{0.0f, 0.0f, 1.0f};
  for (std::size_t i = 1; i < hull.size(); ++i) {
    const HullEdge there{hull[0], hull[i]}, back{hull[i], hull[0]};
    const PoolGrowth growth(pool, everywhere, 1e-9);
    std::vector<Vector2d> vertices;
    const auto visit = [&](const Vector2d& p) { vertices.push_back(p); };
    EXPECT_NEAR(growth.beyond(there, 30, visit) + growth.beyond(back, 30, visit), signedArea(hull), 1e-9)
        << "to vertex " << i;
    EXPECT_EQ(vertices.size(), hull.size() - 2) << "to vertex " << i;
    EXPECT_LT(growth.beyond(there, 1, visit), growth.beyond(there, 30, visit) + 1e-12) << "to vertex " << i;
  }
}

}  // namespace
}  // namespace boxgrasp
