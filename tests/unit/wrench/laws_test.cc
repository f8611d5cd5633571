#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "boxgrasp/base/error.h"
#include "boxgrasp/wrench/grasp_wrench_space.h"
#include "random_contacts.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

using Contacts = std::vector<Contact>;
using testing::HasSubstr;
using testing::ThrowsMessage;

WrenchOptions scaledOptions(double friction) {
  WrenchOptions result;
  result.friction = friction;
  result.torque_scale_m = test::kGraspRadius;
  return result;
}

// On a box, at the corners of a coarse grid: full of symmetries, coincident wrenches and flat sets.
Contact boxContact(std::mt19937_64& random) {
  const auto axis = static_cast<int>(uniformIndex(random, 3));
  Contact result;
  for (double& x : result.p_C) x = 0.01 * (static_cast<double>(uniformIndex(random, 5)) - 2.0);
  const double side = uniformIndex(random, 2) ? 1.0 : -1.0;
  result.p_C[axis] = side * test::kGraspRadius;
  result.normal_C[axis] = -side;
  return result;
}

Contacts boxGrasp(std::mt19937_64& random, std::size_t contacts) {
  Contacts result(contacts);
  for (Contact& contact : result) contact = boxContact(random);
  return result;
}

// Two to six contacts, round or of a box, or more where there is no friction.
Contacts someGrasp(std::mt19937_64& random, double friction) {
  const std::size_t contacts = 2 + uniformIndex(random, 5) + (friction > 0.0 ? 0 : 5);
  return uniformIndex(random, 2) ? boxGrasp(random, contacts) : test::randomGrasp(random, contacts);
}

double support(const Contacts& contacts, const WrenchOptions& options, const Wrench& direction) {
  double result = -std::numeric_limits<double>::infinity(), sum = 0.0;
  for (const Contact& contact : contacts) {
    double most = -std::numeric_limits<double>::infinity();
    for (const Wrench& edge : edgeWrenches(contact, options)) most = std::max(most, direction.dot(edge));
    result = std::max(result, most);
    sum += std::max(0.0, most);
  }
  return options.norm == WrenchNorm::l1 ? result : sum;
}

void expectSame(const GraspQuality& got, const GraspQuality& expected, const char* law) {
  EXPECT_EQ(got.force_closure, expected.force_closure) << law;
  EXPECT_NEAR(got.epsilon, expected.epsilon, 1e-8) << law;
  EXPECT_NEAR(got.volume, expected.volume, 1e-6 * expected.volume + 1e-12) << law;
}

TEST(EdgeWrenches, LieOnTheCircularConeWithUnitNormalForce) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 100; ++round) {
    const Contact contact = test::randomContact(random);
    WrenchOptions options = scaledOptions(uniform(random, 0.1, 1.0));
    options.cone_edges = 3 + static_cast<int>(uniformIndex(random, 10));
    options.p_CG = 0.01 * test::randomDirection(random);
    const auto edges = edgeWrenches(contact, options);
    ASSERT_EQ(edges.size(), options.cone_edges);
    for (const Wrench& edge : edges) {
      const Vector3d force = edge.head<3>(), tangential = force - contact.normal_C;
      EXPECT_NEAR(force.dot(contact.normal_C), 1.0, 1e-14);
      EXPECT_NEAR(tangential.norm(), options.friction, 1e-14);
      const Vector3d torque = (contact.p_C - options.p_CG).cross(force) / options.torque_scale_m;
      EXPECT_TRUE(edge.tail<3>().isApprox(torque, 1e-14));
    }
  }
}

TEST(EdgeWrenches, StartAlongTheTangentOfTheConvention) {
  const WrenchOptions options = scaledOptions(0.5);
  const Contact along_z{Vector3d::Zero(), Vector3d::UnitZ()}, along_x{Vector3d::Zero(), Vector3d::UnitX()};
  EXPECT_TRUE(edgeWrenches(along_z, options)[0].head<3>().isApprox(Vector3d(0.0, 0.5, 1.0)));
  EXPECT_TRUE(edgeWrenches(along_z, options)[2].head<3>().isApprox(Vector3d(-0.5, 0.0, 1.0)));
  EXPECT_TRUE(edgeWrenches(along_x, options)[0].head<3>().isApprox(Vector3d(1.0, -0.5, 0.0)));
}

TEST(EdgeWrenches, AreOneWithoutFriction) {
  std::mt19937_64 random(2);
  Contact contact = test::randomContact(random);
  EXPECT_EQ(edgeWrenches(contact, scaledOptions(0.0)).size(), 1u);
  contact.friction = 0.3;
  EXPECT_EQ(edgeWrenches(contact, scaledOptions(0.0)).size(), 8u) << "the contact's own friction comes first";
}

// Contacts that push and pull at six places give the wrenches +-M's columns, the corners of a cross-polytope:
// its facets have the normals M^-T s for the 64 vectors of signs s, its volume is 2^6 |det M| / 6!.
TEST(GraspQuality, OfOpposedWrenchesIsThatOfTheirCrossPolytope) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 50; ++round) {
    Contacts contacts;
    Eigen::Matrix<double, 6, 6> M;
    for (int i = 0; i < 6; ++i) {
      const Contact push = test::randomContact(random);
      M.col(i) = edgeWrenches(push, scaledOptions(0.0))[0];
      contacts.insert(contacts.end(), {push, {push.p_C, -push.normal_C}});
    }
    double steepest = 0.0;
    for (int signs = 0; signs < 64; ++signs) {
      Wrench s;
      for (int i = 0; i < 6; ++i) s[i] = signs >> i & 1 ? 1.0 : -1.0;
      steepest = std::max(steepest, M.transpose().lu().solve(s).norm());
    }
    const double volume = 64.0 * std::abs(M.determinant()) / 720.0;
    expectSame(graspQuality(contacts, scaledOptions(0.0)), {1.0 / steepest, volume, true}, "closed form");
    EXPECT_TRUE(forceClosure(contacts, scaledOptions(0.0)));
  }
}

TEST(GraspQuality, IsBoundedByTheSupportInEveryDirection) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 60; ++round) {
    const Contacts contacts = test::randomGrasp(random, 3 + uniformIndex(random, 4));
    const WrenchOptions options = scaledOptions(0.8);
    const GraspQuality quality = graspQuality(contacts, options);
    if (!quality.force_closure) continue;
    for (int i = 0; i < 200; ++i) {
      Wrench direction;
      for (double& x : direction) x = normal(random);
      ASSERT_GE(support(contacts, options, direction.normalized()), quality.epsilon - 1e-9);
    }
  }
}

TEST(GraspQuality, IgnoresTheOrderAndTheRepetitionOfContacts) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 40; ++round) {
    const WrenchOptions options = scaledOptions(0.6);
    Contacts contacts = someGrasp(random, options.friction);
    const GraspQuality expected = graspQuality(contacts, options);
    std::reverse(contacts.begin(), contacts.end());
    std::swap(contacts[0], contacts[1]);
    expectSame(graspQuality(contacts, options), expected, "another order of contacts");
    contacts.push_back(contacts.front());
    expectSame(graspQuality(contacts, options), expected, "a contact given twice");
  }
}

TEST(GraspQuality, IsTheSameInTheMirror) {
  std::mt19937_64 random(6);
  for (int round = 0; round < 40; ++round) {
    const WrenchOptions options = scaledOptions(0.6);
    Contacts contacts = someGrasp(random, options.friction);
    const GraspQuality expected = graspQuality(contacts, options);
    for (Contact& contact : contacts) {
      contact.p_C.y() *= -1.0;
      contact.normal_C.y() *= -1.0;
    }
    expectSame(graspQuality(contacts, options), expected, "mirrored in y, as are the tangents");
  }
}

TEST(GraspQuality, MovesWithTheCentreOfGravityAndScalesWithTheObject) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 40; ++round) {
    WrenchOptions options = scaledOptions(0.6);
    Contacts contacts = someGrasp(random, options.friction);
    const GraspQuality expected = graspQuality(contacts, options);
    options.p_CG = test::randomDirection(random);
    options.torque_scale_m *= 3.0;
    for (Contact& contact : contacts) contact.p_C = options.p_CG + 3.0 * contact.p_C;
    expectSame(graspQuality(contacts, options), expected, "thrice the size, elsewhere");
  }
}

TEST(GraspQuality, OfBoundedForcesIsNotLessThanOfABoundedSum) {
  std::mt19937_64 random(8);
  for (int round = 0; round < 12; ++round) {
    WrenchOptions options = scaledOptions(0.9);
    options.cone_edges = 4;
    const Contacts contacts = test::randomGrasp(random, 3);
    const GraspQuality sum = graspQuality(contacts, options);
    options.norm = WrenchNorm::linf;
    const GraspQuality each = graspQuality(contacts, options);
    EXPECT_EQ(each.force_closure, sum.force_closure);
    EXPECT_GE(each.epsilon, sum.epsilon);
    EXPECT_GT(each.volume, sum.volume);
    Wrench direction;
    for (double& x : direction) x = normal(random);
    EXPECT_LE(each.epsilon, support(contacts, options, direction.normalized()) + 1e-9);
  }
}

// Without friction the sum of the segments from 0 to w_i is a zonotope:
// its volume is the sum of |det| over all sets of six segments.
TEST(GraspQuality, OfSegmentsHasTheVolumeOfTheirZonotope) {
  std::mt19937_64 random(9);
  WrenchOptions options = scaledOptions(0.0);
  options.norm = WrenchNorm::linf;
  const Contacts contacts = test::randomGrasp(random, 7);
  double volume = 0.0;
  for (std::size_t left_out = 0; left_out < 7; ++left_out) {
    Eigen::Matrix<double, 6, 6> segments;
    for (std::size_t i = 0, column = 0; i < 7; ++i) {
      if (i != left_out) segments.col(static_cast<int>(column++)) = edgeWrenches(contacts[i], options)[0];
    }
    volume += std::abs(segments.determinant());
  }
  EXPECT_NEAR(graspQuality(contacts, options).volume, volume, 1e-6 * volume);
}

TEST(ForceClosure, IsThatOfTheHull) {
  std::mt19937_64 random(10);
  int closed = 0;
  for (int round = 0; round < 1500; ++round) {
    const double friction = 0.25 * static_cast<double>(uniformIndex(random, 5));
    WrenchOptions options = scaledOptions(friction);
    options.cone_edges = 4 + static_cast<int>(uniformIndex(random, 3));
    const Contacts contacts = someGrasp(random, friction);
    const GraspQuality quality = graspQuality(contacts, options);
    closed += quality.force_closure;
    ASSERT_EQ(forceClosure(contacts, options), quality.force_closure)
        << "set " << round << " of " << contacts.size() << " contacts with friction " << friction
        << ": epsilon " << quality.epsilon << ", volume " << quality.volume;
    ASSERT_EQ(quality.epsilon > 0.0, quality.force_closure);
  }
  EXPECT_GT(closed, 300);
  EXPECT_LT(closed, 1200);
}

TEST(ForceClosure, IsNotLostByMoreFriction) {
  std::mt19937_64 random(11);
  for (int round = 0; round < 1000; ++round) {
    const Contacts contacts = someGrasp(random, 1.0);
    bool before = false;
    for (const double friction : {0.0, 0.1, 0.2, 0.4, 0.8, 1.6}) {
      const bool now = forceClosure(contacts, scaledOptions(friction));
      ASSERT_GE(now, before) << "set " << round << " at friction " << friction;
      before = now;
    }
  }
}

TEST(ForceClosure, IsNotLostByOneContactMore) {
  std::mt19937_64 random(12);
  for (int round = 0; round < 500; ++round) {
    const double friction = uniformIndex(random, 2) ? 0.0 : 0.5;
    Contacts contacts;
    bool before = false;
    for (int i = 0; i < 14; ++i) {
      contacts.push_back(uniformIndex(random, 2) ? boxContact(random) : test::randomContact(random));
      const bool now = forceClosure(contacts, scaledOptions(friction));
      ASSERT_GE(now, before) << "set " << round << " at contact " << i;
      before = now;
    }
  }
}

TEST(ForceClosure, TellsGraspsOnEitherSideOfTheBoundary) {
  std::mt19937_64 random(13);
  int boundaries = 0;
  for (int round = 0; round < 60; ++round) {
    const Contacts contacts = test::randomGrasp(random, 3);
    double open = 0.0, closed = 5.0;
    if (!forceClosure(contacts, scaledOptions(closed))) continue;
    while (closed - open > 1e-7) {
      const double middle = 0.5 * (open + closed);
      (forceClosure(contacts, scaledOptions(middle)) ? closed : open) = middle;
    }
    ++boundaries;
    EXPECT_FALSE(graspQuality(contacts, scaledOptions(open - 1e-6)).force_closure) << "set " << round;
    EXPECT_TRUE(graspQuality(contacts, scaledOptions(closed + 1e-6)).force_closure) << "set " << round;
  }
  EXPECT_GT(boundaries, 20);
}

TEST(GraspQuality, OfTooFewDimensionsIsNoClosureAndNoVolume) {
  std::mt19937_64 random(14);
  const Contacts one = test::randomGrasp(random, 1);
  const Contacts opposed{{Vector3d(-0.05, 0, 0), Vector3d::UnitX()},
                         {Vector3d(0.05, 0, 0), -Vector3d::UnitX()}};
  for (const Contacts& contacts : {Contacts{}, one, Contacts(5, one[0]), opposed}) {
    for (const double friction : {0.0, 0.5}) {
      const WrenchOptions options = scaledOptions(friction);
      expectSame(graspQuality(contacts, options), {-1.0, 0.0, false}, "flat");
      EXPECT_FALSE(forceClosure(contacts, options));
    }
  }
}

void expectRefused(const Contacts& contacts, const WrenchOptions& options, const std::string& part) {
  EXPECT_THAT([&] { graspQuality(contacts, options); }, ThrowsMessage<InputError>(HasSubstr(part)));
}

void expectRefusedByBoth(const Contacts& contacts, const WrenchOptions& options, const std::string& part) {
  expectRefused(contacts, options, part);
  EXPECT_THAT([&] { forceClosure(contacts, options); }, ThrowsMessage<InputError>(HasSubstr(part)));
}

TEST(WrenchErrors, NameTheContactAndItsValue) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Contact good{Vector3d::Zero(), Vector3d::UnitX()};
  Contact nowhere = good, bent = good, sticky = good;
  nowhere.p_C.y() = nan;
  bent.normal_C *= 1.5;
  sticky.friction = nan;
  expectRefusedByBoth({good, nowhere}, {}, "contact 1: its position is (0, nan, 0), but must be finite");
  expectRefusedByBoth({bent}, {}, "contact 0: its normal (1.5, 0, 0) has the length 1.5");
  expectRefusedByBoth({good, good, sticky}, {}, "contact 2: its friction is nan");
}

TEST(WrenchErrors, NameTheOptionAndItsBound) {
  WrenchOptions friction, edges, scale, centre;
  friction.friction = -0.1;
  edges.cone_edges = 2;
  scale.torque_scale_m = 0.0;
  centre.p_CG.x() = std::numeric_limits<double>::infinity();
  expectRefusedByBoth({}, friction, "option 'friction' is -0.1, but must be finite and at least 0");
  expectRefusedByBoth({}, edges, "option 'cone_edges' is 2, but must be from 3 to 64");
  expectRefusedByBoth({}, scale, "option 'torque_scale_m' is 0, but must be finite and above 0");
  expectRefusedByBoth({}, centre, "option 'p_CG' is (inf, 0, 0), but must be finite");
}

TEST(WrenchErrors, RefuseASumTooLarge) {
  std::mt19937_64 random(15);
  WrenchOptions options = scaledOptions(0.5);
  options.norm = WrenchNorm::linf;
  expectRefused(test::randomGrasp(random, 5), options, "the Minkowski sum of 5 contacts has 59049 points");
}

TEST(WrenchErrors, RefuseAUnionTooLarge) {
  std::mt19937_64 random(16);
  WrenchOptions options = scaledOptions(0.5);
  options.cone_edges = 64;
  expectRefused(test::randomGrasp(random, 5), options, "the cones of 5 contacts have 320 edges");
  options.cone_edges = 25;
  EXPECT_NO_THROW(graspQuality(test::randomGrasp(random, 5), options)) << "125 edges";
  options.cone_edges = 64;
  EXPECT_NO_THROW(graspQuality(test::randomGrasp(random, 3), options)) << "three have a hull of their own";
}

}  // namespace
}  // namespace boxgrasp
