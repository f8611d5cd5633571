#include "boxgrasp/simulation/driven_hand.h"

#include <gtest/gtest.h>

namespace boxgrasp {
namespace {

// Until the clutch opens, the outer joint follows the inner by the hand's coupling, and bodies are where the
// kinematics say.
TEST(DrivenHand, FollowsTheKinematicsWhileNothingIsInTheWay) {
  const HandDescription& hand = barrettHand();
  PhysicsWorld world(0.002);
  DrivenHand driven(hand, {0.3, {0.1, 0.2, 0.3}}, Pose::Identity(), {}, world);
  for (int i = 0; i < 200; ++i) {
    driven.drive();
    world.step({});
  }
  const HandJoints joints = driven.joints();
  EXPECT_NEAR(joints.inner[kF1], 0.1 + 0.4 * DriveOptions{}.closing_rate_rad_s, 0.02);
  const HandGeometry expected = forwardKinematics(hand, joints);
  for (std::size_t i = 1; i < driven.parts().size(); ++i) {
    const auto& [part, body] = driven.parts()[i];
    const Vector3d tip = world.pose(body) * part.centers_B.back();
    EXPECT_LT((tip - expected.links[i - 1].b).norm(), 3e-4) << part.name;
  }
  for (int finger = 0; finger < 3; ++finger) {
    EXPECT_NEAR(driven.outerJoints()[finger], hand.coupling * joints.inner[finger], 3e-3);
  }
}

// A wall that stops the inner link: the clutch opens, the inner joint stays, and the outer one goes on at 4/3
// of the motor's rate to its limit (definitions, 3.3).
TEST(DrivenHand, ClutchLetsTheOuterLinkGoOnAlone) {
  const HandDescription& hand = barrettHand();
  PhysicsWorld world(0.002);
  DrivenHand driven(hand, {0.0, {0.5, 0.5, 0.5}}, Pose::Identity(), {}, world);
  const DrivenFinger& thumb = driven.fingers()[kThumb];
  const BodyId wall = world.addKinematicBody(Pose::Identity());
  double released_at = -1, fastest = 0;
  for (int i = 0; i < 800; ++i) {
    driven.drive();
    std::vector<PhysicalContact> contacts;
    const double depth = driven.joints().inner[kThumb] - 0.9;
    if (depth > 0) {
      const Vector3d p = world.pose(thumb.inner).translation();
      const Vector3d along = p - Vector3d(0, -hand.base_radius, hand.joint_height);
      const Vector3d against = Vector3d::UnitX().cross(along).normalized();
      contacts.push_back({thumb.inner, wall, p, against, depth * along.norm(), 0.0});
    }
    world.step(contacts);
    if (thumb.state != DriveState::closing && released_at < 0) released_at = driven.joints().inner[kThumb];
    if (thumb.state == DriveState::clutch_open) fastest = std::max(fastest, world.rate(thumb.outer_hinge));
  }
  const double lever = 0.5 * hand.inner_length;
  const double yielded = DriveOptions{}.breakaway_torque_nm / (ContactMaterial{}.stiffness * lever * lever);
  EXPECT_NEAR(released_at, 0.9 + yielded, 0.002) << "the clutch opened at another torque than its own";
  EXPECT_NEAR(driven.joints().inner[kThumb], released_at, 0.01) << "the worm gear does not turn back";
  EXPECT_NEAR(fastest, (1 + hand.coupling) * DriveOptions{}.closing_rate_rad_s, 0.05);
  EXPECT_NEAR(driven.outerJoints()[kThumb], hand.outer_max, 0.01);
  EXPECT_NEAR(driven.joints().inner[kF1], hand.inner_max, 0.01) << "the other fingers go on";
}

HandDescription gripper() {
  return readHandDescription(BOXGRASP_SOURCE_DIR "/deploy/hands/parallel_gripper.toml");
}

// Both jaws keep the same distance from the middle, and bodies are where the kinematics say.
TEST(DrivenHand, JawsFollowTheKinematics) {
  const HandDescription hand = gripper();
  PhysicsWorld world(0.002);
  DrivenHand driven(hand, {0.0, {0.2, 0.2, 0.2}}, Pose::Identity(), {}, world);
  for (int i = 0; i < 200; ++i) {
    driven.drive();
    world.step(driven.selfContacts());
  }
  const HandJoints joints = driven.joints();
  EXPECT_NEAR(joints.inner[kF1], 0.2 + 0.4 * DriveOptions{}.closing_rate_rad_s, 0.02);
  EXPECT_NEAR(joints.inner[kThumb], joints.inner[kF1], 0.02);
  const HandGeometry expected = forwardKinematics(hand, joints);
  for (std::size_t i = 1; i < driven.parts().size(); ++i) {
    const auto& [part, body] = driven.parts()[i];
    EXPECT_EQ(part.name, expected.links[i - 1].name);
    EXPECT_LT((world.pose(body) * part.centers_B.back() - expected.links[i - 1].b).norm(), 3e-4) << part.name;
  }
}

// An empty gripper closes until its pads meet.
TEST(DrivenHand, EmptyJawsCloseAndStall) {
  const HandDescription hand = gripper();
  PhysicsWorld world(0.002);
  DrivenHand driven(hand, {0.0, {0.0, 0.0, 0.0}}, Pose::Identity(), {}, world);
  for (int i = 0; i < 1500 && !driven.stalled(); ++i) {
    driven.drive();
    world.step(driven.selfContacts());
  }
  EXPECT_TRUE(driven.stalled());
  EXPECT_NEAR(driven.joints().inner[kThumb], hand.inner_max, 0.1);
}

}  // namespace
}  // namespace boxgrasp
