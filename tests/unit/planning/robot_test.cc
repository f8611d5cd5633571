// The robot's frame and its limits: laws on whole plans, and the hand against boxes.
#include "boxgrasp/planning/robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "boxgrasp/base/random.h"
#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/planning/grasp_planner.h"
#include "error_of.h"
#include "random_pose.h"
#include "test_model.h"

namespace boxgrasp {
namespace {

using testing::HasSubstr;

PlanResult planOf(const PlanRequest& request, const RobotOptions& robot = {}) {
  PlannerOptions options;
  options.threads = 1;
  options.robot = robot;
  return GraspPlanner(barrettHand(), test::linearModel(), options).plan(request);
}

PlanRequest mug(int top_k = 0) {
  PlanRequest request;
  request.cloud_C = sampleSurface(parametricObject("mug"), 12'000, 7);
  request.top_k = top_k;
  return request;
}

std::size_t rejected(const PlanResult& result, const std::string& reason) {
  const auto found = result.report.rejected.find(reason);
  return found == result.report.rejected.end() ? 0 : found->second;
}

std::pair<std::size_t, std::size_t> stage(const PlanResult& result, const std::string& name) {
  for (const Stage& one : result.report.stages) {
    if (one.name == name) return {one.in, one.out};
  }
  return {0, 0};
}

TEST(RobotOptions, AreValid) { EXPECT_NO_THROW(RobotOptions{}.validate()); }

TEST(RobotOptions, NameWhatCannotBe) {
  const auto problem = [](auto change) {
    RobotOptions options;
    change(options);
    return test::errorOf([&] { options.validate(); });
  };
  EXPECT_THAT(problem([](auto& o) {
                o.camera_quaternion_wxyz = {0, 0, 0, 0};
              }),
              HasSubstr("'camera_quaternion_wxyz' is 0 0 0 0"));
  EXPECT_THAT(problem([](auto& o) { o.palm_position_m[1] = NAN; }),
              HasSubstr("'palm_position_m' is 0 nan 0"));
  EXPECT_THAT(problem([](auto& o) { o.approach = {0, 0, 0}; }), HasSubstr("'approach' is 0 0 0"));
  EXPECT_THAT(problem([](auto& o) { o.approach_cone_rad = 4; }), HasSubstr("'approach_cone_rad' is 4"));
  EXPECT_THAT(problem([](auto& o) { o.workspace_max_m[2] = -RobotOptions::kUnbounded; }),
              HasSubstr("'workspace_min_m, workspace_max_m' is from"));
  EXPECT_THAT(problem([](auto& o) {
                o.forbidden_m = {{0, 0, 0, 1, 1, 0}};
              }),
              HasSubstr("'forbidden_m' is from 0 0 0 to 1 1 0"));
  EXPECT_THAT(problem([](auto& o) { o.lift_m = -1; }), HasSubstr("'lift_m' is -1"));
}

// Without limits there are no further stages, and the motion is as it is told.
TEST(Robot, TheMotionGoesStraightInAndAgainstGravity) {
  PlanRequest request = mug(5);
  request.gravity_C = Vector3d(0, 0, -9.81);
  RobotOptions robot;
  robot.lift_m = 0.07;
  const PlanResult result = planOf(request, robot);
  ASSERT_EQ(result.outcome, Outcome::grasps) << result.message;
  EXPECT_EQ(stage(result, "approach").first + stage(result, "reach").first, 0u);
  for (const Grasp& grasp : result.grasps) {
    const Vector3d in_C = grasp.X_CP.translation() - grasp.X_CP_pregrasp.translation();
    const Vector3d out_C = grasp.X_CP_lift.translation() - grasp.X_CP.translation();
    EXPECT_TRUE(in_C.isApprox(ClearanceOptions{}.approach_m * grasp.approach_C, 1e-9)) << in_C.transpose();
    EXPECT_TRUE(out_C.isApprox(Vector3d(0, 0, 0.07), 1e-9)) << out_C.transpose();
    EXPECT_TRUE(grasp.X_CP_pregrasp.linear().isApprox(grasp.X_CP.linear(), 1e-12));
    EXPECT_TRUE(grasp.X_CP_lift.linear().isApprox(grasp.X_CP.linear(), 1e-12));
  }
}

// All limits hold for every grasp, wherever the camera stands; and what is left out is what breaks one.
TEST(Robot, GraspsKeepToTheCone) {
  std::mt19937_64 random(5);
  const PlanResult all = planOf(mug());
  for (const double cone_rad : {0.3, 1.0, 2.0}) {
    PlanRequest request = mug();
    const Pose X_RC = test::randomPose(random);
    request.robot.X_RC = X_RC;
    request.robot.approach = {X_RC.linear() * Vector3d(0, 0, -2), cone_rad};
    const PlanResult some = planOf(request);
    const auto allowed = [&](const Grasp& grasp) { return grasp.approach_C.z() <= -std::cos(cone_rad); };
    EXPECT_TRUE(std::ranges::all_of(some.grasps, allowed));
    EXPECT_GT(some.grasps.size(), 0u) << some.message;
    EXPECT_EQ(some.grasps.size() < all.grasps.size(),
              rejected(some, "face from where the robot may not come") > 0);
    EXPECT_GT(rejected(some, "face from where the robot may not come"), 0u);
  }
}

TEST(Robot, SaysThatItMayNotComeFromAnywhere) {
  PlanRequest request = mug();
  request.robot.approach = {Vector3d(1, 1, 1), 0.01};
  const PlanResult result = planOf(request);
  EXPECT_EQ(result.outcome, Outcome::no_grasp);
  EXPECT_THAT(result.message, HasSubstr("stage 'approach' let none of"));
  EXPECT_THAT(result.message, HasSubstr("robot.approach_cone_rad"));
}

TEST(Robot, ThePalmStaysInTheWorkspace) {
  PlanRequest request = mug();
  const Eigen::AlignedBox3d workspace_R(Vector3d(-0.5, -0.5, 0.9), Vector3d(0.5, 0.5, 1.28));
  request.robot.X_RC = makePose(Matrix3d::Identity(), {0, 0, 1});
  request.robot.workspace_R = workspace_R;
  const PlanResult result = planOf(request);
  const auto [in, out] = stage(result, "reach");
  EXPECT_GT(out, 0u) << result.message;
  EXPECT_LT(out, in) << "nothing was out of reach: the test tests nothing";
  for (const Grasp& grasp : result.grasps) {
    for (const Pose& X_CP : {grasp.X_CP_pregrasp, grasp.X_CP, grasp.X_CP_lift})
      EXPECT_TRUE(workspace_R.contains(Vector3d(X_CP.translation() + Vector3d::UnitZ())));
  }
}

// The hand of every grasp that is left keeps out, by brute force over points of its links on the way; and a
// region that swallows everything leaves none.
TEST(Robot, TheHandKeepsOutOfForbiddenRegions) {
  PlanRequest request = mug();
  request.gravity_C = Vector3d(0, 0, -1);
  const Eigen::AlignedBox3d forbidden(Vector3d(0.08, -1, -1), Vector3d(RobotOptions::kUnbounded, 1, 1));
  request.robot.forbidden_R = {forbidden};
  const PlanResult result = planOf(request);
  EXPECT_GT(rejected(result, "hand enters a forbidden region"), 0u);
  ASSERT_GT(result.grasps.size(), 0u) << result.message;
  for (const Grasp& grasp : result.grasps) {
    const HandGeometry open = forwardKinematics(barrettHand(), grasp.pregrasp);
    for (const Capsule& link : open.links) {
      for (int step = 0; step <= 10; ++step) {
        for (const Vector3d& end_P : {link.a, link.b}) {
          const Vector3d end_C = grasp.X_CP * end_P - 0.015 * step * grasp.approach_C;
          EXPECT_GT(forbidden.exteriorDistance(end_C), link.radius - 1e-9) << link.name;
        }
      }
    }
  }
  request.robot.forbidden_R = {Eigen::AlignedBox3d(Vector3d(-1, -1, -1), Vector3d(1, 1, 1))};
  const PlanResult none = planOf(request);
  EXPECT_EQ(none.outcome, Outcome::no_grasp);
  EXPECT_THAT(none.message, HasSubstr("stage 'reach' let none of"));
  EXPECT_THAT(none.message, HasSubstr("robot.forbidden_m"));
}

// A box at a fingertip, before, between and behind: the hand enters it exactly when it is on its way.
TEST(Robot, MeetsABoxOnItsWayAlone) {
  const HandDescription& hand = barrettHand();
  GraspMotion motion;
  motion.X_CP = Pose::Identity();
  motion.X_CP_pregrasp = makePose(Matrix3d::Identity(), {0, 0, -0.15});
  motion.X_CP_lift = makePose(Matrix3d::Identity(), {0, 0, -0.05});
  motion.pregrasp = {0.0, {0.0, 0.0, 0.0}};
  motion.closed = {0.0, {1.2, 1.2, 1.2}};
  const auto meets = [&](const Vector3d& center) {
    RobotRequest request;
    request.forbidden_R = {{center - Vector3d::Constant(0.001), center + Vector3d::Constant(0.001)}};
    return Robot({}, request).obstacle(hand, motion, 4).has_value();
  };
  const Vector3d open_tip = forwardKinematics(hand, motion.pregrasp).tips_P[kThumb];
  const Vector3d closed_tip = forwardKinematics(hand, motion.closed).tips_P[kThumb];
  EXPECT_TRUE(meets(open_tip));
  EXPECT_TRUE(meets(open_tip - Vector3d(0, 0, 0.12))) << "on the way in";
  EXPECT_TRUE(meets(closed_tip)) << "closed";
  EXPECT_TRUE(meets(closed_tip - Vector3d(0, 0, 0.05))) << "lifted";
  EXPECT_TRUE(meets({0, 0, -0.2})) << "the palm before the grasp";
  EXPECT_FALSE(meets(open_tip + Vector3d(0, 0, 0.02))) << "beyond the fingertip";
  EXPECT_FALSE(meets(open_tip - Vector3d(0, 0.02, 0))) << "beside the fingertip";
  EXPECT_FALSE(meets({0, 0, -0.24})) << "behind the palm before the grasp";
}

TEST(Robot, WhatIsForbiddenFarAwayForbidsNothing) {
  PlanRequest request = mug(3);
  request.robot.forbidden_R = {Eigen::AlignedBox3d(Vector3d(200, 200, 200), Vector3d(300, 300, 300))};
  const PlanResult result = planOf(request);
  EXPECT_EQ(result.grasps.size(), 3u) << result.message;
  EXPECT_EQ(rejected(result, "hand enters a forbidden region"), 0u);
}

TEST(Robot, GravityIsTheRequestsOrTheRobots) {
  PlanRequest request = mug(3);
  RobotOptions robot;
  robot.gravity = {0, 0, -9.8};
  request.robot.X_RC = makePose(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX()).toRotationMatrix(), {1, 2, 3});
  // Down in R is -y in C.
  const PlanResult configured = planOf(request, robot);
  request.gravity_C = Vector3d(0, -1, 0);
  const PlanResult told = planOf(request);
  ASSERT_EQ(configured.grasps.size(), told.grasps.size());
  for (std::size_t i = 0; i < told.grasps.size(); ++i)
    EXPECT_TRUE(configured.grasps[i].X_CP_lift.isApprox(told.grasps[i].X_CP_lift, 1e-9));
}

// A table that is told stands for one that is seen: the hand does not reach through it.
TEST(Robot, TheTableMayBeTold) {
  PlanRequest request = mug();
  request.table_C = Plane{Vector3d(0, 0, 2), 0.0};
  const PlanResult result = planOf(request);
  ASSERT_GT(result.grasps.size(), 0u) << result.message;
  EXPECT_THAT(result.report.notes, testing::Contains(HasSubstr("a table was given")));
  for (const Grasp& grasp : result.grasps) {
    for (const Capsule& link : forwardKinematics(barrettHand(), grasp.joints).links)
      EXPECT_GT(std::min((grasp.X_CP * link.a).z(), (grasp.X_CP * link.b).z()) - link.radius, -0.006)
          << link.name;
  }
  request.table_C->normal_C.setZero();
  EXPECT_THAT(planOf(request).message, HasSubstr("the table's normal"));
}

}  // namespace
}  // namespace boxgrasp
