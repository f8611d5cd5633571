#include "boxgrasp/simulation/protocols.h"

#include <gtest/gtest.h>

#include <numbers>

#include "boxgrasp/base/error.h"
#include "solids.h"

namespace boxgrasp {
namespace {

TrialInput fromAbove(double height_m) {
  TrialInput input;
  input.X_OP = makePose(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()).toRotationMatrix(),
                        Vector3d(0, 0, height_m));
  input.pregrasp = {0.0, {0.5, 0.5, 0.5}};
  return input;
}

SimulatedObject block(double density_kg_m3 = 500) {
  return makeSimulatedObject(boxMesh({0.09, 0.06, 0.12}), {.density_kg_m3 = density_kg_m3, .field = {}});
}

TEST(Protocols, FirmGraspComesThroughBoth) {
  const SimulatedObject object = block();
  const SixPushResult pushed = pushSixWays(barrettHand(), object, fromAbove(0.13));
  EXPECT_TRUE(pushed.held()) << describe(pushed.outcome);
  EXPECT_LT(pushed.displacement_m, 0.002);
  const SixGravityResult turned = holdInSixGravities(barrettHand(), object, fromAbove(0.13));
  EXPECT_EQ(turned.directions_held, 6) << describe(turned.outcome);
  EXPECT_EQ(turned.outcome, TrialOutcome::held);
}

// The pushes are as strong for a cork as for a lead block: density is the protocol's.
TEST(Protocols, UseTheirOwnDensity) {
  const SixPushResult light = pushSixWays(barrettHand(), block(100), fromAbove(0.13));
  const SixPushResult heavy = pushSixWays(barrettHand(), block(11340), fromAbove(0.13));
  EXPECT_NEAR(light.displacement_m, heavy.displacement_m, 1e-9);
  EXPECT_TRUE(heavy.held());
}

TEST(Protocols, NothingInTheHandHoldsNothing) {
  const SixPushResult pushed = pushSixWays(barrettHand(), block(), fromAbove(1.0));
  EXPECT_EQ(pushed.outcome, TrialOutcome::missed);
  EXPECT_TRUE(std::isnan(pushed.displacement_m));
  EXPECT_EQ(holdInSixGravities(barrettHand(), block(), fromAbove(1.0)).directions_held, 0);
  EXPECT_EQ(holdInSixGravities(barrettHand(), block(), fromAbove(0.0)).outcome, TrialOutcome::collided);
}

// Nothing but friction holds a block between parallel fingers against gravity along x and -z.
TEST(Protocols, WithoutFrictionABlockSlipsOutSideways) {
  const SixGravityResult result =
      holdInSixGravities(barrettHand(), block(), fromAbove(0.13), {}, {.friction = 0.0});
  EXPECT_EQ(result.outcome, TrialOutcome::unstable);
  EXPECT_LE(result.directions_held, 3);
  const SixPushResult pushed = pushSixWays(barrettHand(), block(), fromAbove(0.13), {}, {.friction = 0.0});
  EXPECT_FALSE(pushed.held());
  EXPECT_GT(pushed.displacement_m, 0.02);
}

TEST(Protocols, AHardPushLosesWhatAWeakOneDoesNot) {
  const SixPushResult pushed =
      pushSixWays(barrettHand(), block(), fromAbove(0.13), {}, {.acceleration_m_s2 = 400});
  EXPECT_FALSE(pushed.held());
}

TEST(Protocols, RefuseBadOptions) {
  EXPECT_THROW(pushSixWays(barrettHand(), block(), fromAbove(0.13), {}, {.friction = -1}), InputError);
  EXPECT_THROW(pushSixWays(barrettHand(), block(), fromAbove(0.13), {}, {.push_time_s = 0}), InputError);
  EXPECT_THROW(holdInSixGravities(barrettHand(), block(), fromAbove(0.13), {}, {.time_s = NAN}), InputError);
}

}  // namespace
}  // namespace boxgrasp
