// The fast hulls by closed forms, also where rounding is all that tells points apart, and against slower
// ones.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "boxgrasp/base/tolerances.h"
#include "boxgrasp/wrench/general_hull.h"
#include "boxgrasp/wrench/simplicial_hull.h"
#include "boxgrasp/wrench/three_cone_hull.h"
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

std::array<ForceCone, 3> conesOf(const std::vector<Contact>& contacts, int edges) {
  WrenchOptions options;
  options.cone_edges = edges;
  std::array<ForceCone, 3> result;
  for (int i = 0; i < 3; ++i) {
    result[i] = {contacts[i].p_C / test::kGraspRadius, contacts[i].normal_C, {}};
    for (const Wrench& wrench : edgeWrenches(contacts[i], options))
      result[i].edges.push_back(wrench.head<3>());
  }
  return result;
}

Points wrenchesOf(const std::array<ForceCone, 3>& cones) {
  Points result;
  for (std::size_t edge = 0; edge < cones[0].edges.size(); ++edge) {
    for (const ForceCone& cone : cones) {
      const Vector3d& f = cone.edges[edge];
      result.emplace_back() << f, cone.arm.cross(f);
    }
  }
  return result;
}

// Cones of the same number of edges, each with a friction of its own.
std::array<ForceCone, 3> randomCones(std::mt19937_64& random) {
  std::vector<Contact> contacts = test::randomGrasp(random, 3);
  for (Contact& contact : contacts) contact.friction = uniform(random, 0.2, 1.5);
  return conesOf(contacts, 3 + static_cast<int>(uniformIndex(random, 8)));
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

TEST(ThreeConeHull, IsTheSimplicialHullOfTheSameWrenches) {
  std::mt19937_64 random(6);
  int closed = 0, answered = 0;
  for (int round = 0; round < 1000; ++round) {
    const auto cones = randomCones(random);
    const WrenchHull expected = wrenchHull(wrenchesOf(cones));
    const bool is_closed = expected.inradius > tolerance::kWrenchMargin;
    closed += is_closed;
    const auto got = threeConeHull(cones);
    if (!got) continue;
    answered += is_closed;
    EXPECT_NEAR(got->volume, expected.volume, 1e-9 * expected.volume) << "set " << round;
    ASSERT_EQ(got->inradius > tolerance::kWrenchMargin, is_closed) << "set " << round;
    if (is_closed) {
      EXPECT_NEAR(got->inradius, expected.inradius, 1e-9) << "set " << round;
    }
  }
  ASSERT_GT(closed, 300) << "too few of the random grasps are in force closure to tell anything";
  EXPECT_GE(answered, 0.99 * closed) << "most hulls with the origin inside have facets that are well apart";
}

TEST(ThreeConeHull, IsQhulls) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 30; ++round) {
    const auto cones = randomCones(random);
    const auto got = threeConeHull(cones);
    if (!got || got->inradius <= 0.0) continue;
    const WrenchHull expected = generalHull(wrenchesOf(cones));
    EXPECT_NEAR(got->volume, expected.volume, 1e-6 * expected.volume) << "set " << round;
    EXPECT_NEAR(got->inradius, expected.inradius, 1e-8) << "set " << round;
  }
}

// Where several facets lie in one plane, or nearly, it answers rightly or not at all.
TEST(ThreeConeHull, DoesNotGuessWhereContactsAreSymmetric) {
  std::mt19937_64 random(8);
  for (int round = 0; round < 120; ++round) {
    const double moved = round < 10 ? 0.0 : std::pow(10.0, -17.0 + 0.15 * round);
    std::vector<Contact> contacts;
    for (int i = 0; i < 3; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / 3.0;
      const Vector3d outward =
          (Vector3d(std::cos(angle), std::sin(angle), 0.0) + moved * test::randomDirection(random))
              .normalized();
      contacts.push_back({test::kGraspRadius * outward, -outward, 0.5});
    }
    const auto cones = conesOf(contacts, 4 + round % 5);
    const auto got = threeConeHull(cones);
    if (!got) continue;
    const WrenchHull expected = wrenchHull(wrenchesOf(cones));
    EXPECT_NEAR(got->volume, expected.volume, 1e-7 * expected.volume) << "moved by " << moved;
    EXPECT_NEAR(got->inradius, expected.inradius, 1e-7) << "moved by " << moved;
  }
}

TEST(ThreeConeHull, DoesNotVouchForFlatHullsNorForWhatIsNoNumber) {
  std::mt19937_64 random(9);
  const std::vector<Contact> grasp = test::randomGrasp(random, 3);
  auto in_line = grasp, coincident = grasp, broken = grasp;
  in_line[2].p_C = (in_line[0].p_C + in_line[1].p_C) / 2.0;
  coincident[1].p_C = coincident[0].p_C;
  broken[1].p_C.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(threeConeHull(conesOf(in_line, 8)));
  EXPECT_FALSE(threeConeHull(conesOf(coincident, 8)));
  EXPECT_FALSE(threeConeHull(conesOf(broken, 8)));
}

TEST(SimplicialHull, DoesNotVouchForPointsThatAreNoNumbers) {
  Points points = cube();
  points[20][3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(simplicial(points));
}

}  // namespace
}  // namespace boxgrasp
