// A parallel gripper as a hand of virtual fingers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/hand/configurations.h"

namespace boxgrasp {
namespace {

using ::testing::HasSubstr;

const std::string kFile = BOXGRASP_SOURCE_DIR "/deploy/hands/parallel_gripper.toml";

HandDescription gripper() { return readHandDescription(kFile); }

std::string complaintAfter(const std::string& from, const std::string& to) {
  std::ostringstream text;
  text << std::ifstream(kFile).rdbuf();
  std::string changed = text.str();
  const auto at = changed.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  try {
    parseHandDescription(changed.replace(at, from.size(), to), "my.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

TEST(ParallelGripper, MistakesInItsFileAreNamed) {
  EXPECT_THAT(complaintAfter("fingers = \"prismatic\"", "fingers = \"telescopic\""),
              HasSubstr("\"prismatic\" (jaws)"));
  EXPECT_THAT(complaintAfter("fingers = \"prismatic\"", "fingers = 3"), HasSubstr("'fingers'"));
  EXPECT_THAT(complaintAfter("fingers = \"prismatic\"", ""), HasSubstr("unknown key 'jaw'"))
      << "without the word it is a Barrett hand";
  EXPECT_THAT(complaintAfter("[jaw]", "[finger]"), HasSubstr("parallel_gripper.toml explains"));
  EXPECT_THAT(complaintAfter("pad_length_mm = 25.0", ""), HasSubstr("'pad_length_mm' is missing"));
  EXPECT_THAT(complaintAfter("max_deg = 121.75", "max_deg = 130"), HasSubstr("at most half_opening_mm"));
  EXPECT_THAT(complaintAfter("stem_radius_mm = 5.0", "stem_radius_mm = 6.0"), HasSubstr("before the pad"));
}

TEST(ParallelGripper, HasNoValueLeftOpen) {
  const HandDescription hand = gripper();
  for (const auto member :
       {&HandDescription::inner_rest, &HandDescription::outer_rest, &HandDescription::coupling,
        &HandDescription::inner_min, &HandDescription::outer_max, &HandDescription::spread_min,
        &HandDescription::spread_max, &HandDescription::knuckle_radius, &HandDescription::outer_radius,
        &HandDescription::depth_slope, &HandDescription::depth_offset})
    EXPECT_TRUE(std::isfinite(hand.*member));
  EXPECT_DOUBLE_EQ(linearDepth(hand, 0.01), tipHeight(hand, 0.3)) << "the tip is always as high";
}

// The pads face each other, one opening apart, and their faces are where the joints say.
TEST(ParallelGripper, PadsAreOneOpeningApart) {
  const HandDescription hand = gripper();
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const double q = uniform(random, hand.inner_min, hand.inner_max);
    const HandGeometry pose = forwardKinematics(hand, {0.0, {q, q, q}});
    const double opening = 2 * (hand.base_radius - hand.slide_per_rad * q);
    const Vector3d jaw = 0.5 * (pose.tips_P[kF1] + pose.tips_P[kF2]);
    EXPECT_NEAR((jaw - pose.tips_P[kThumb]).norm() - 2 * hand.tip_radius, opening, 1e-12);
    EXPECT_LT((jaw + pose.tips_P[kThumb]).head<2>().norm(), 1e-12) << "not midway between the jaws";
    for (int finger = 0; finger < 3; ++finger) {
      EXPECT_NEAR(std::abs(pose.tips_P[finger].y()), hand.base_radius + extension(hand, q) + hand.tip_radius,
                  1e-12);
      for (int link = 1; link < 3; ++link) {
        const Capsule& capsule = pose.links[3 * finger + link];
        EXPECT_GE(std::abs(capsule.a.y()) - capsule.radius, 0.5 * opening - 1e-12)
            << capsule.name << " stands out before the pad's face";
      }
    }
    const Capsule& bar = pose.links[3 * kThumb + 2];
    EXPECT_NEAR((bar.b - bar.a).norm(), (pose.tips_P[kF1] - pose.tips_P[kF2]).norm(), 1e-12)
        << "both pads are as wide";
  }
}

TEST(ParallelGripper, JointAndExtensionAreInverse) {
  const HandDescription hand = gripper();
  const Reach reach = fingerReach(hand);
  EXPECT_DOUBLE_EQ(reach.extension_max_m, 0.0);
  for (int i = 0; i <= 100; ++i) {
    const double e = std::lerp(reach.extension_min_m, reach.extension_max_m, i / 100.0);
    const auto joint = innerForExtension(hand, e);
    ASSERT_TRUE(joint) << e;
    EXPECT_NEAR(extension(hand, *joint), e, 1e-15);
  }
  EXPECT_FALSE(innerForExtension(hand, 0.001)) << "wider than it opens";
}

// A bar of this width along x of F, turned: a pinch in its middle, the thumb below.
Triplet pinchOf(const HandDescription& hand, double width_m, double turn, double step_m = 0.0) {
  const Eigen::Rotation2Dd R(turn);
  Triplet pinch;
  pinch.regions = {0, 0, 1};
  pinch.points_F = {R * Vector2d(hand.spread_offset, 0.5 * width_m),
                    R * Vector2d(-hand.spread_offset, 0.5 * width_m + step_m),
                    R * Vector2d(0, -0.5 * width_m)};
  pinch.normals_F = {R * Vector2d(0, -1), R * Vector2d(0, -1), R * Vector2d(0, 1)};
  pinch.nearest_depth_m = {0.0, 0.0, 0.0};
  pinch.farthest_depth_m = {0.05, 0.05, 0.05};
  return pinch;
}

// Forward kinematics put the pads' faces onto the points, and both jaws keep the same distance.
TEST(ParallelGripper, ReachesEveryBarThatFitsBetweenItsPads) {
  const HandDescription hand = gripper();
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const double width = uniform(random, 0.001, 0.12);
    const Triplet pinch = pinchOf(hand, width, uniform(random, -3.0, 3.0));
    const auto found = findConfigurations(hand, pinch, 0, {}).configurations;
    EXPECT_EQ(!found.empty(), width <= 2 * hand.base_radius) << width;
    for (const HandConfiguration& c : found) {
      EXPECT_EQ(c.joints.inner[kF1], c.joints.inner[kF2]);
      EXPECT_EQ(c.joints.inner[kF1], c.joints.inner[kThumb]);
      EXPECT_EQ(c.joints.spread, 0.0);
      const HandGeometry pose = forwardKinematics(hand, c.joints);
      for (int finger = 0; finger < 3; ++finger) {
        const Vector3d push(c.push_F[finger].x(), c.push_F[finger].y(), 0);
        const Vector3d touched_F = c.X_FP * pose.tips_P[finger] + hand.tip_radius * push;
        const Vector2d& point_F = pinch.points_F[c.point_of_finger[finger]];
        const double tilt_m = 2 * hand.spread_offset * std::sin(std::abs(c.thumb_angle));
        EXPECT_LT((touched_F.head<2>() - point_F).norm(), 5e-4 + tilt_m) << "width " << width;
      }
    }
  }
}

TEST(ParallelGripper, AJawCannotBendToAStep) {
  const HandDescription hand = gripper();
  EXPECT_FALSE(findConfigurations(hand, pinchOf(hand, 0.03, 0.4, 0.001), 0, {}).configurations.empty());
  EXPECT_TRUE(findConfigurations(hand, pinchOf(hand, 0.03, 0.4, 0.010), 0, {}).configurations.empty());
}

}  // namespace
}  // namespace boxgrasp
