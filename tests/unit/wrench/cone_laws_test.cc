// Cones that lie in each other make hulls that lie in each other.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "boxgrasp/wrench/grasp_wrench_space.h"
#include "random_contacts.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

WrenchOptions coneOptions(int edges, double friction) {
  WrenchOptions result;
  result.friction = friction;
  result.cone_edges = edges;
  result.torque_scale_m = test::kGraspRadius;
  return result;
}

void expectWithin(const GraspQuality& inner, const GraspQuality& outer, int round) {
  EXPECT_LE(inner.epsilon, outer.epsilon + 1e-8) << "set " << round;
  EXPECT_LE(inner.volume, outer.volume * (1.0 + 1e-6)) << "set " << round;
  EXPECT_LE(inner.force_closure, outer.force_closure) << "set " << round;
}

TEST(GraspQuality, GrowsWithFriction) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 40; ++round) {
    const auto contacts = test::randomGrasp(random, 3 + round % 2);
    for (const double friction : {0.1, 0.4, 0.8}) {
      expectWithin(graspQuality(contacts, coneOptions(8, friction)),
                   graspQuality(contacts, coneOptions(8, 1.3 * friction)), round);
    }
  }
}

// A rotation about the centre of gravity turns the cone's edges against the tangents' convention. The cone
// with friction mu cos(pi / m) has its edges within every inscribed one of m edges and friction mu: the
// measures of both frames converge as 1 / m^2.
TEST(GraspQuality, IsTheSameInEveryFrameUpToTheConesEdges) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 40; ++round) {
    const auto contacts = test::randomGrasp(random, 3);
    const Matrix3d rotation = test::randomRotation(random);
    auto turned = contacts;
    for (Contact& contact : turned) {
      contact.p_C = rotation * contact.p_C;
      contact.normal_C = (rotation * contact.normal_C).normalized();
    }
    const int edges = 8 + 2 * (round % 5);
    const double outer = 0.9, inner = outer * std::cos(std::numbers::pi / edges);
    expectWithin(graspQuality(turned, coneOptions(edges, inner)),
                 graspQuality(contacts, coneOptions(edges, outer)), round);
    expectWithin(graspQuality(contacts, coneOptions(edges, inner)),
                 graspQuality(turned, coneOptions(edges, outer)), round);
  }
}

}  // namespace
}  // namespace boxgrasp
