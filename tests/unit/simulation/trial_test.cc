#include "boxgrasp/simulation/trial.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <numbers>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/parallel.h"
#include "solids.h"

namespace boxgrasp {
namespace {

using ::testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

// From above, the palm's z down and its y along -y of O, at (0, y) and this high above the origin.
TrialInput fromAbove(double height_m, double spread, double y_m = 0.0, double open = 0.5) {
  TrialInput input;
  input.X_OP =
      makePose(Eigen::AngleAxisd(kPi, Vector3d::UnitX()).toRotationMatrix(), Vector3d(0, y_m, height_m));
  input.pregrasp = {spread, {open, open, open}};
  return input;
}

const SimulatedObject& ball() {
  static const SimulatedObject object = makeSimulatedObject(sphereMesh(0.04, 24));
  return object;
}

// Between parallel fingers: 60 mm across, taller than the fingers reach around.
const SimulatedObject& block() {
  static const SimulatedObject object = makeSimulatedObject(boxMesh({0.09, 0.06, 0.12}));
  return object;
}

TrialOptions closingOnly() {
  TrialOptions options;
  options.last_stage = TrialStage::close;
  return options;
}

Vector3d sumOfForces(const TrialResult& result) {
  Vector3d sum = Vector3d::Zero();
  for (const TrialContact& contact : result.contacts) sum += contact.force_O;
  return sum;
}

Vector3d sumOfTorques(const TrialResult& result, const Vector3d& about_O) {
  Vector3d sum = Vector3d::Zero();
  for (const TrialContact& contact : result.contacts) sum += (contact.p_O - about_O).cross(contact.force_O);
  return sum;
}

// A ball in the middle of three fingers at 120 degrees: the spread axes are 25 mm beside the hand's, so that
// the fingers' planes meet 25 cot(60 deg) mm towards the thumb.
TEST(Trial, BallBetweenThreeFingersIsTouchedThreeTimesNearItsEquator) {
  const TrialInput input = fromAbove(0.09, kPi / 3, -0.025 / std::tan(kPi / 3));
  const TrialResult result = runTrial(barrettHand(), ball(), input);
  EXPECT_EQ(result.outcome, TrialOutcome::held) << result.report;
  ASSERT_EQ(result.contacts.size(), 3u);
  for (int finger = 0; finger < 3; ++finger) {
    const TrialContact& contact = result.contacts[finger];
    EXPECT_EQ(contact.finger, finger);
    EXPECT_NEAR(contact.p_O.norm(), 0.04, 3e-4) << "not on the ball";
    EXPECT_LT(std::abs(contact.p_O.z()), 0.012) << "far from the equator";
    EXPECT_GT(contact.normal_O.dot(-contact.p_O.normalized()), 0.99);
    const double pressed = contact.force_O.dot(contact.normal_O);
    EXPECT_LE((contact.force_O - pressed * contact.normal_O).norm(), 0.5 * pressed * std::sqrt(2.0) + 1e-9);
  }
  EXPECT_LT(sumOfForces(result).norm(), 0.05) << sumOfForces(result).transpose();
  EXPECT_LT(sumOfTorques(result, ball().center_O).norm(), 0.005);
  EXPECT_TRUE(result.quality.force_closure);
  EXPECT_GT(result.quality.epsilon, 0.1);
}

TEST(Trial, MirrorImageOfTheHandGivesTheMirrorImageOfTheGrasp) {
  const TrialResult result = runTrial(barrettHand(), block(), fromAbove(0.13, 0.0), closingOnly());
  EXPECT_NEAR(result.joints.inner[kF1], result.joints.inner[kF2], 1e-3);
  EXPECT_NEAR(result.outer[kF1], result.outer[kF2], 1e-2);
}

double pressedBy(const TrialResult& result, int finger) {
  double sum = 0;
  for (const TrialContact& contact : result.contacts) {
    if (contact.finger == finger) sum += contact.force_O.dot(contact.normal_O);
  }
  return sum;
}

// By statics: three fingers at 120 degrees press alike, and of three on two opposite faces one presses as
// much as the two. The motors press until the heaviest loaded finger bears almost what it may.
TEST(Trial, FingersPressAsStaticsSaysAndNoneHarderThanItMay) {
  const double most = barrettHand().max_tip_force;
  const TrialResult round =
      runTrial(barrettHand(), ball(), fromAbove(0.09, kPi / 3, -0.025 / std::tan(kPi / 3)), closingOnly());
  for (int finger = 0; finger < 3; ++finger) {
    EXPECT_GT(pressedBy(round, finger), 0.8 * most) << "finger " << finger;
    EXPECT_LT(pressedBy(round, finger), most) << "finger " << finger;
  }
  const TrialResult flat = runTrial(barrettHand(), block(), fromAbove(0.13, 0.0), closingOnly());
  EXPECT_NEAR(pressedBy(flat, kThumb), 0.93 * most, 0.05 * most);
  EXPECT_NEAR(pressedBy(flat, kF1), 0.5 * pressedBy(flat, kThumb), 0.05 * most);
  EXPECT_NEAR(pressedBy(flat, kF2), 0.5 * pressedBy(flat, kThumb), 0.05 * most);
}

// Even closed at the real hand's full rate.
TEST(Trial, FingersDoNotPassThroughThinThings) {
  TrialOptions options = closingOnly();
  options.physics.drive.closing_rate_rad_s = 2.44;
  const double thick_m = 0.002;
  const SimulatedObject wall = makeSimulatedObject(boxMesh({0.09, thick_m, 0.12}));
  const SimulatedObject pen = makeSimulatedObject(boxMesh({0.14, 0.008, 0.008}));
  for (const auto& [object, height_m] : {std::pair(&wall, 0.13), {&pen, 0.09}}) {
    const TrialResult result = runTrial(barrettHand(), *object, fromAbove(height_m, 0.0), options);
    ASSERT_EQ(result.outcome, TrialOutcome::held) << result.report;
    for (const TrialContact& contact : result.contacts) {
      // The palm's y is -y of O: the thumb is at +y, and its pad's normal points into the object.
      EXPECT_LT(contact.normal_O.y() * (contact.finger == kThumb ? 1 : -1), 0) << contact.link;
      EXPECT_GT(contact.p_O.y() * (contact.finger == kThumb ? 1 : -1), 0) << contact.link;
    }
  }
}

// A block turned and off the middle, so that no two fingers do alike.
TrialInput askew() {
  TrialInput input = fromAbove(0.13, 0.2, 0.004);
  input.X_OP = input.X_OP * Eigen::Translation3d(0.008, 0, 0) * Eigen::AngleAxisd(0.15, Vector3d::UnitZ());
  return input;
}

void expectImage(const TrialResult& result, const TrialResult& image, const Eigen::Affine3d& X_IO,
                 const std::array<int, 3>& finger_of_image) {
  EXPECT_EQ(result.outcome, image.outcome) << result.report << " / " << image.report;
  EXPECT_NEAR(result.quality.epsilon, image.quality.epsilon, 0.01);
  EXPECT_NEAR(result.lift_slip_m, image.lift_slip_m, 1e-3);
  EXPECT_NEAR(result.push_force_n, image.push_force_n, 0.1 * result.push_force_n);
  ASSERT_EQ(result.contacts.size(), image.contacts.size());
  for (const TrialContact& contact : result.contacts) {
    double nearest = INFINITY;
    for (const TrialContact& other : image.contacts) {
      if (contact.finger >= 0 && other.finger != finger_of_image[contact.finger]) continue;
      nearest = std::min(nearest, (X_IO * contact.p_O - other.p_O).norm());
    }
    EXPECT_LT(nearest, 1e-3) << contact.link;
  }
}

TEST(Trial, MirroredGraspHasTheMirroredResult) {
  const Eigen::Affine3d mirror(Eigen::Scaling(-1.0, 1.0, 1.0));  // of the block, its own image, and of P
  TrialInput mirrored = askew();
  mirrored.X_OP = Pose((mirror * mirrored.X_OP * mirror).matrix());
  expectImage(runTrial(barrettHand(), block(), askew()), runTrial(barrettHand(), block(), mirrored), mirror,
              {kF2, kF1, kThumb});
}

TEST(Trial, MovedGraspHasTheSameResult) {
  const Pose X_MO = makePose(Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()).toRotationMatrix(),
                             Vector3d(0.3, -0.2, 0.5));
  TriangleMesh mesh = boxMesh({0.09, 0.06, 0.12});
  for (Vector3d& p : mesh.vertices) p = X_MO * p;
  TrialInput moved_input = askew();
  moved_input.X_OP = X_MO * moved_input.X_OP;
  moved_input.gravity_O = X_MO.linear() * moved_input.gravity_O;
  expectImage(runTrial(barrettHand(), block(), askew()),
              runTrial(barrettHand(), makeSimulatedObject(mesh), moved_input), Eigen::Affine3d(X_MO.matrix()),
              {kF1, kF2, kThumb});
}

// What friction alone holds grows with it; and no direction is held by more than all contacts can give.
TEST(Trial, PushedObjectHoldsWhatFrictionGives) {
  double held_n = 0.0;
  for (const double friction : {0.4, 0.6, 0.8}) {
    TrialOptions options;
    options.physics.friction = friction;
    const TrialResult result = runTrial(barrettHand(), block(), fromAbove(0.13, 0.0), options);
    EXPECT_GT(result.push_force_n, 1.2 * held_n) << "friction " << friction;
    held_n = result.push_force_n;
    const double pressed = pressedBy(result, kF1) + pressedBy(result, kF2) + pressedBy(result, kThumb);
    EXPECT_LT(held_n, 1.4 * friction * pressed) << "friction " << friction;
  }
}

TEST(Trial, HeldBlockComesThroughLiftShakeAndPull) {
  const TrialResult result = runTrial(barrettHand(), block(), fromAbove(0.13, 0.0));
  EXPECT_EQ(result.outcome, TrialOutcome::held) << result.report;
  EXPECT_TRUE(result.stalled);
  EXPECT_LT(result.lift_slip_m, 0.003);
  EXPECT_LT(result.lift_rotation_rad, 0.05);
  // Two fingers against one with at most some 15 N at the tips, friction 0.5: less than 2 * 0.5 * 2 * 20 N.
  EXPECT_GT(result.push_force_n, 5.0);
  EXPECT_LT(result.push_force_n, 40.0);
}

TEST(Trial, WithoutFrictionTheBlockFallsOut) {
  TrialOptions options;
  options.physics.friction = 0.0;
  const TrialResult result = runTrial(barrettHand(), block(), fromAbove(0.13, 0.0), options);
  EXPECT_EQ(result.outcome, TrialOutcome::lost_in_lift) << result.report;
  EXPECT_FALSE(result.quality.force_closure);
}

TEST(Trial, TooHeavyABlockIsLost) {
  const SimulatedObject lead =
      makeSimulatedObject(boxMesh({0.09, 0.06, 0.12}), {.density_kg_m3 = 11340, .field = {}});
  const TrialResult result = runTrial(barrettHand(), lead, fromAbove(0.13, 0.0));
  EXPECT_EQ(result.outcome, TrialOutcome::lost_in_lift) << result.report;
}

TEST(Trial, ClosingOnNothingEndsAtTheLimits) {
  const HandDescription& hand = barrettHand();
  const TrialResult result = runTrial(hand, ball(), fromAbove(1.0, 0.0));
  EXPECT_EQ(result.outcome, TrialOutcome::missed);
  EXPECT_TRUE(result.stalled);
  EXPECT_TRUE(result.contacts.empty());
  for (int finger = 0; finger < 3; ++finger) {
    EXPECT_NEAR(result.joints.inner[finger], hand.inner_max, 0.01) << "finger " << finger;
    EXPECT_NEAR(result.outer[finger], hand.outer_max, 0.01) << "finger " << finger;
  }
}

TEST(Trial, FingersThatMeetStopEachOther) {
  const TrialResult result = runTrial(barrettHand(), ball(), fromAbove(1.0, kPi / 3));
  EXPECT_EQ(result.outcome, TrialOutcome::missed);
  EXPECT_LT(result.joints.inner[kF1], barrettHand().inner_max - 0.1);
}

// The palm is to end 20 mm inside the ball; the thumb's knuckle, of 12.4 mm radius about 4.6 mm below the
// palm, meets the ball's top before it, and a millimetre is grazing.
constexpr double kKnuckleShort = 0.02 + 0.0124 - 0.0046 - 0.001;

TEST(Trial, TouchOnTheWayIsACollision) {
  const TrialResult result = runTrial(barrettHand(), ball(), fromAbove(0.02, 0.0));
  EXPECT_EQ(result.outcome, TrialOutcome::collided);
  EXPECT_EQ(result.touched, "thumb knuckle");
  EXPECT_NEAR(result.stopped_short_m, kKnuckleShort, 0.002);
  EXPECT_THAT(result.report, HasSubstr("thumb knuckle touched"));
}

TEST(Trial, TouchInTheLastMillimetresIsNoCollision) {
  // The palm is to end where its thumb's knuckle is 4 mm deep in the ball.
  TrialOptions options = closingOnly();
  const double deep_m = 0.004;
  const TrialInput input = fromAbove(0.02 + kKnuckleShort - deep_m, 0.0);
  const TrialResult stopped = runTrial(barrettHand(), ball(), input, options);
  EXPECT_NE(stopped.outcome, TrialOutcome::collided) << stopped.report;
  EXPECT_NEAR(stopped.stopped_short_m, deep_m, 0.002);
  options.touch_short_m = 0;
  EXPECT_EQ(runTrial(barrettHand(), ball(), input, options).outcome, TrialOutcome::collided);
}

TEST(Trial, HandThatBacksUpFromATouchClosesThere) {
  TrialOptions options = closingOnly();
  options.back_up_on_touch = true;
  const TrialResult result = runTrial(barrettHand(), ball(), fromAbove(0.02, 0.0), options);
  EXPECT_EQ(result.outcome, TrialOutcome::held) << result.report;
  EXPECT_NEAR(result.stopped_short_m, kKnuckleShort + options.back_up_m, 0.002);
}

bool sameBits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

void expectSame(const TrialResult& a, const TrialResult& b) {
  EXPECT_EQ(a.outcome, b.outcome);
  EXPECT_EQ(a.report, b.report);
  EXPECT_TRUE(sameBits(a.lift_slip_m, b.lift_slip_m));
  EXPECT_TRUE(sameBits(a.push_force_n, b.push_force_n));
  EXPECT_TRUE(sameBits(a.quality.epsilon, b.quality.epsilon));
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  for (std::size_t i = 0; i < a.contacts.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE(sameBits(a.contacts[i].p_O[k], b.contacts[i].p_O[k]));
      EXPECT_TRUE(sameBits(a.contacts[i].force_O[k], b.contacts[i].force_O[k]));
    }
  }
}

TEST(Trial, IsTheSameToTheBitInEveryRunAndOnEveryThread) {
  const std::vector<TrialInput> inputs{fromAbove(0.09, 0.0), fromAbove(0.075, kPi / 3), fromAbove(0.1, 0.4),
                                       fromAbove(0.08, 0.2, 0.01)};
  std::vector<TrialResult> alone(inputs.size()), together(2 * inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) alone[i] = runTrial(barrettHand(), ball(), inputs[i]);
  parallelFor(together.size(), 2, [&](std::size_t i) {
    together[i] = runTrial(barrettHand(), ball(), inputs[(5 * i) % inputs.size()]);
  });
  for (std::size_t i = 0; i < together.size(); ++i) expectSame(together[i], alone[(5 * i) % inputs.size()]);
}

TEST(Trial, OnlookerSeesAllPhasesInOrderAndChangesNothing) {
  const TrialInput input = fromAbove(0.13, 0);
  std::vector<TrialMoment> moments;
  const TrialResult watched = runTrial(barrettHand(), block(), input, {}, {},
                                       {0.01, [&](const TrialMoment& m) { moments.push_back(m); }});
  const TrialResult alone = runTrial(barrettHand(), block(), input);
  EXPECT_EQ(watched.steps, alone.steps);
  EXPECT_EQ(watched.push_force_n, alone.push_force_n);

  std::vector<TrialPhase> phases;
  for (const TrialMoment& moment : moments) {
    if (phases.empty() || phases.back() != moment.phase) phases.push_back(moment.phase);
    ASSERT_EQ(moment.links_W.size(), 9u);
    for (std::size_t link = 0; link < 9; ++link) {  // rigid, and joined end to end
      const Capsule& here = moment.links_W[link];
      EXPECT_NEAR((here.b - here.a).norm(), (moments[0].links_W[link].b - moments[0].links_W[link].a).norm(),
                  1e-9);
      if (link % 3 == 0) continue;
      EXPECT_NEAR((here.a - moment.links_W[link - 1].b).norm(), 0, 2e-3) << here.name;
    }
  }
  using enum TrialPhase;
  EXPECT_THAT(phases, ::testing::ElementsAre(approach, touch, press, settle, lift, shake, push));
  EXPECT_NEAR(moments.back().X_WO.translation().z(), 0.2, 0.03) << "lifted by 0.2 m";
}

TEST(Trial, StopsWhenToldTo) {
  const StopToken expired(StopToken::Clock::now() - std::chrono::seconds(1));
  EXPECT_THROW(runTrial(barrettHand(), ball(), fromAbove(0.09, 0.0), {}, expired), Stopped);
  const StopToken soon(StopToken::Clock::now() + std::chrono::milliseconds(5));
  TrialOptions long_wait;
  long_wait.wait_time_s = 1e6;
  EXPECT_THROW(runTrial(barrettHand(), ball(), fromAbove(0.09, 0.0), long_wait, soon), Stopped);
}

std::string refusal(const TrialInput& input, const TrialOptions& options) {
  try {
    runTrial(barrettHand(), ball(), input, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(Trial, RefusesBadOptionsAndInputByName) {
  TrialOptions options;
  options.physics.step_s = 0.1;
  EXPECT_THAT(refusal(fromAbove(0.09, 0), options), HasSubstr("step_s"));
  options = {};
  options.lift_acceleration_m_s2 = 0;
  EXPECT_THAT(refusal(fromAbove(0.09, 0), options), HasSubstr("lift_acceleration_m_s2"));
  options = {};
  options.physics.drive.breakaway_torque_nm = -1;
  EXPECT_THAT(refusal(fromAbove(0.09, 0), options), HasSubstr("breakaway_torque_nm"));
  EXPECT_THAT(refusal(fromAbove(0.09, 4.0), {}), HasSubstr("spread"));
  EXPECT_THAT(refusal(fromAbove(0.09, 0, 0, -0.5), {}), HasSubstr("inner joint"));
  EXPECT_THAT(refusal(fromAbove(NAN, 0), {}), HasSubstr("not finite"));
  TrialInput sheared = fromAbove(0.09, 0);
  sheared.X_OP.linear()(0, 1) = 0.5;
  EXPECT_THAT(refusal(sheared, {}), HasSubstr("rotation"));
  TrialInput weightless = fromAbove(0.09, 0);
  weightless.gravity_O.setZero();
  EXPECT_THAT(refusal(weightless, {}), HasSubstr("gravity"));
}

// Off its middle too: the jaws bring the block there, and press on it with their force from both sides.
TEST(Trial, AParallelGripperHoldsABlockWithItsForce) {
  const HandDescription hand = readHandDescription(BOXGRASP_SOURCE_DIR "/deploy/hands/parallel_gripper.toml");
  const SimulatedObject bar = makeSimulatedObject(boxMesh({0.10, 0.04, 0.06}));
  for (const double off_m : {0.0, 0.006}) {
    const TrialResult result = runTrial(hand, bar, fromAbove(0.06, 0.0, off_m, 0.1));
    EXPECT_EQ(result.outcome, TrialOutcome::held) << result.report;
    EXPECT_NEAR(result.joints.inner[kF1], (hand.base_radius - 0.02) / hand.slide_per_rad, 0.1);
    EXPECT_NEAR(pressedBy(result, kF1) + pressedBy(result, kF2), hand.max_tip_force, 2.0);
    EXPECT_NEAR(pressedBy(result, kThumb), hand.max_tip_force, 2.0);
    EXPECT_LT(sumOfForces(result).norm(), 0.5);
    EXPECT_TRUE(result.quality.force_closure);
  }
}

}  // namespace
}  // namespace boxgrasp
