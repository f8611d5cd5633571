// The fast hull by closed forms, also where rounding is all that tells points apart, and against qhull's.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "boxgrasp/wrench/general_hull.h"
#include "boxgrasp/wrench/simplicial_hull.h"
#include "random_contacts.h"

namespace boxgrasp {
namespace {

using Points = std::vector<Wrench>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

std::optional<WrenchHull> simplicial(const Points& points) {
  return simplicialHull(Eigen::Map<const WrenchMatrix>(points.front().data(), 6, points.size()));
}

Wrench randomPoint(std::mt19937_64& random) {
  Wrench result;
  for (double& x : result) x = normal(random);
  return result;
}

// The corners of [-1, 1]^6, one axis away from the first corner first: seven that are independent.
Points cube() {
  Points result;
  for (int corner = 0; corner < 64; ++corner) {
    result.push_back(-Wrench::Ones());
    for (int i = 0; i < 6; ++i) result.back()[i] += 2.0 * (corner >> i & 1);
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const Wrench& a, const Wrench& b) { return a.sum() < b.sum(); });
  return result;
}

// One edge of each contact after the other, so that the first seven wrenches are independent.
Points wrenchesOf(const std::vector<Contact>& contacts, double friction) {
  WrenchOptions options;
  options.friction = friction;
  options.torque_scale_m = test::kGraspRadius;
  Points result;
  for (int edge = 0; edge < options.cone_edges; ++edge) {
    for (const Contact& contact : contacts) result.push_back(edgeWrenches(contact, options)[edge]);
  }
  return result;
}

void expectHull(const std::optional<WrenchHull>& got, const WrenchHull& expected, double tolerance) {
  ASSERT_TRUE(got) << "expected inradius " << expected.inradius << ", volume " << expected.volume;
  EXPECT_NEAR(got->inradius, expected.inradius, tolerance * std::abs(expected.inradius));
  EXPECT_NEAR(got->volume, expected.volume, tolerance * expected.volume);
}

TEST(SimplicialHull, OfASimplexHasItsSevenFacets) {
  constexpr double kShift = 0.125;
  Points corners(7, Wrench::Constant(-kShift));
  for (int i = 0; i < 6; ++i) corners[i + 1][i] += 1.0;
  expectHull(simplicial(corners), {(1.0 - 6.0 * kShift) / std::sqrt(6.0), 1.0 / 720.0}, 1e-14);
}

TEST(SimplicialHull, IgnoresPointsOnFacetsInsideAndRepeated) {
  std::mt19937_64 random(1);
  Points points = cube();
  for (int round = 0; round < 60; ++round) {
    Wrench point = Wrench::NullaryExpr([&] { return uniform(random, -1.0, 1.0); });
    for (int i = 0; i < round % 6; ++i) point[uniformIndex(random, 6)] = 1.0;
    points.push_back(point);
  }
  points.insert(points.end(), points.begin(), points.begin() + 20);
  expectHull(simplicial(points), {1.0, 64.0}, 1e-12);
}

// A linear map with determinant d multiplies the volume by |d|; the facet x_i = 1 of the cube gets the
// distance 1 / |row i of the map's inverse|.
TEST(SimplicialHull, FollowsLinearMapsHoweverFlat) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 60; ++round) {
    Matrix6d map = Matrix6d::NullaryExpr([&] { return normal(random); });
    map.col(round % 6) *= std::pow(10.0, -0.1 * round);
    Points points = cube();
    for (Wrench& point : points) point = map * point;
    SCOPED_TRACE(round);
    const double inradius = 1.0 / map.inverse().rowwise().norm().maxCoeff();
    expectHull(simplicial(points), {inradius, 64.0 * std::abs(map.determinant())}, 1e-6);
  }
}

// Every facet of the cube has 32 corners, moved off its plane by anything from rounding upwards.
TEST(SimplicialHull, BearsPointsThatAreAlmostOnAFacet) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 60; ++round) {
    const double moved = std::pow(10.0, -17.0 + 0.2 * round);
    Points points = cube();
    for (Wrench& point : points) point += moved * randomPoint(random);
    const auto hull = simplicial(points);
    if (!hull) continue;
    EXPECT_NEAR(hull->inradius, 1.0, 1e-12 + 20.0 * moved) << "moved by " << moved;
    EXPECT_NEAR(hull->volume, 64.0, 1e-12 + 64.0 * 60.0 * moved) << "moved by " << moved;
  }
}

TEST(SimplicialHull, IsQhullsForGrasps) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 60; ++round) {
    const Points points =
        wrenchesOf(test::randomGrasp(random, 3 + uniformIndex(random, 3)), uniform(random, 0.2, 1.0));
    const auto got = simplicial(points);
    ASSERT_TRUE(got) << "set " << round;
    const WrenchHull expected = generalHull(points);
    EXPECT_NEAR(got->volume, expected.volume, 1e-6 * expected.volume) << "set " << round;
    ASSERT_EQ(got->inradius > 0.0, expected.inradius > 0.0) << "set " << round;
    if (got->inradius <= 0.0) continue;
    EXPECT_NEAR(got->inradius, expected.inradius, 1e-8) << "set " << round;
  }
}

TEST(WrenchHull, AnswersForConesOfAnyWidth) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 60; ++round) {
    const WrenchHull hull =
        wrenchHull(wrenchesOf(test::randomGrasp(random, 3), std::pow(10.0, -10.0 + 0.2 * round)));
    EXPECT_TRUE(std::isfinite(hull.inradius)) << "round " << round;
    EXPECT_GE(hull.volume, 0.0) << "round " << round;
  }
}

TEST(SimplicialHull, DoesNotVouchForPointsThatAreNoNumbers) {
  Points points = cube();
  points[20][3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(simplicial(points));
}

}  // namespace
}  // namespace boxgrasp
