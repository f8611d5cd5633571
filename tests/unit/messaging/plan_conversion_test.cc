// Requests and plans as messages.
#include "boxgrasp/messaging/plan_conversion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "boxgrasp/base/error.h"
#include "random_messages.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(PlanConversion, RequestRoundTrip) {
  std::mt19937_64 random(1);
  PlanRequest request;
  request.cloud_C = test::randomCloud(random, 50);
  request.top_k = 0;
  request.friction = 0.7;
  request.object = 3;
  request.gravity_C = Vector3d(0.1, 0.2, -9.8);
  request.viewpoints_C = {Vector3d::Zero(), Vector3d(0.5, -1, 2)};
  const plan_request_t message = toMessage(request, {"an id", "camera", 2.5, 77});
  EXPECT_EQ(message.request_id, "an id");
  EXPECT_EQ(message.cloud.frame_name, "camera");
  EXPECT_EQ(message.deadline_s, 2.5);
  EXPECT_EQ(message.utime, 77);
  const PlanRequest back = fromMessage(message);
  EXPECT_EQ(back.cloud_C, request.cloud_C);
  EXPECT_EQ(back.top_k, 0);
  EXPECT_EQ(back.friction, 0.7);
  EXPECT_EQ(back.object, 3);
  EXPECT_EQ(back.gravity_C.value(), *request.gravity_C);
  EXPECT_EQ(back.viewpoints_C, request.viewpoints_C);
}

TEST(PlanConversion, WhatARequestSaysOfItsRobotComesBack) {
  std::mt19937_64 random(6);
  PlanRequest request;
  request.table_C = Plane{Vector3d(0, 0, 2), 1.4};
  request.robot.X_RC = test::randomPose(random);
  request.robot.answer_frame = AnswerFrame::robot;
  request.robot.approach = {Vector3d(1, 2, -3), 0.4};
  request.robot.workspace_R = Eigen::AlignedBox3d(Vector3d(-INFINITY, -1, 0), Vector3d(1, 2, INFINITY));
  request.robot.forbidden_R = {Eigen::AlignedBox3d(Vector3d(0, 1, 2), Vector3d(3, 4, 5))};
  const PlanRequest back =
      fromMessage(decoded<plan_request_t>(encoded(toMessage(request, {"id", "f", 0, 0}))));
  EXPECT_NEAR(back.table_C.value().offset_m / back.table_C->normal_C.norm(), 0.7, 1e-12);
  EXPECT_TRUE(back.table_C->normal_C.normalized().isApprox(Vector3d::UnitZ()));
  EXPECT_TRUE(back.robot.X_RC.value().isApprox(*request.robot.X_RC, 1e-12));
  EXPECT_EQ(back.robot.answer_frame, AnswerFrame::robot);
  EXPECT_EQ(back.robot.approach.value().direction_R, Vector3d(1, 2, -3));
  EXPECT_EQ(back.robot.approach->half_angle_rad, 0.4);
  EXPECT_EQ(back.robot.workspace_R.value().min(), request.robot.workspace_R->min());
  EXPECT_EQ(back.robot.workspace_R->max(), request.robot.workspace_R->max());
  ASSERT_EQ(back.robot.forbidden_R.size(), 1u);
  EXPECT_EQ(back.robot.forbidden_R[0].max(), Vector3d(3, 4, 5));
}

TEST(PlanConversion, ZerosAskForDefaults) {
  plan_request_t message{};
  message.cloud = toMessage(PointCloud{}, "f");
  const PlanRequest request = fromMessage(message);
  EXPECT_EQ(request.top_k, PlanRequest{}.top_k);
  EXPECT_EQ(request.friction, PlanRequest{}.friction);
  EXPECT_FALSE(request.gravity_C);
  EXPECT_TRUE(request.viewpoints_C.empty());
  EXPECT_FALSE(request.table_C);
  EXPECT_FALSE(request.robot.X_RC || request.robot.answer_frame || request.robot.approach ||
               request.robot.workspace_R || !request.robot.forbidden_R.empty());
}

TEST(PlanConversion, RefusesImpossibleNumbersAndSaysWhich) {
  std::mt19937_64 random(2);
  const auto problem = [&](auto change) -> std::string {
    plan_request_t message = test::randomRequest(random);
    change(message);
    try {
      fromMessage(message);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(problem([](plan_request_t&) {}), "");
  EXPECT_THAT(problem([](plan_request_t& m) { m.top_k = -2; }), HasSubstr("top_k is -2"));
  EXPECT_THAT(problem([](plan_request_t& m) { m.friction = NAN; }), HasSubstr("friction is nan"));
  EXPECT_THAT(problem([](plan_request_t& m) { m.friction = -0.1; }), HasSubstr("friction is -0.1"));
  EXPECT_THAT(problem([](plan_request_t& m) { m.gravity[1] = INFINITY; }),
              HasSubstr("gravity is (0, inf, -1)"));
  EXPECT_THAT(problem([](plan_request_t& m) {
                m.viewpoints = {{{0, 0, 1}}, {{NAN, 0, 0}}};
              }),
              HasSubstr("viewpoints.position_m is (nan"));
  EXPECT_THAT(problem([](plan_request_t& m) { m.answer_frame = 3; }), HasSubstr("answer_frame is 3"));
  EXPECT_THAT(problem([](plan_request_t& m) { m.has_camera_pose = 1; }),
              HasSubstr("camera_quaternion_wxyz is (0, 0, 0, 0)"));
  EXPECT_THAT(problem([](plan_request_t& m) { m.has_table = 1, m.table_normal[2] = NAN; }),
              HasSubstr("table_normal is (0, 0, nan)"));
}

// Two objects with trees of two and one boxes, and a grasp on each.
PlanResult twoObjects(std::mt19937_64& random) {
  PlanResult result;
  result.outcome = Outcome::grasps;
  result.message = "2 grasps";
  result.model_version = "0123abcd";
  result.objects.resize(2);
  for (BoxTree* tree : {&result.objects[0].tree, &result.objects[1].tree}) {
    BoxNode node;
    node.box.X_CB = test::randomPose(random);
    node.box.extents = {0.3, 0.2, 0.1};
    node.points = {1, 2, 3};
    node.theta = 0.8;
    tree->nodes.push_back(node);
  }
  result.objects[0].tree.nodes.push_back(result.objects[0].tree.nodes[0]);
  result.objects[0].tree.nodes[0].first = 1;
  result.objects[0].tree.nodes[1].parent = 0;
  result.objects[0].tree.nodes[1].stop_reason = "few points";
  for (int object : {1, 0}) {
    Grasp grasp;
    grasp.score = 0.5 + object;
    grasp.X_CP = test::randomPose(random);
    grasp.joints = {0.1, {0.2, 0.3, 0.4}};
    grasp.object = object;
    grasp.box = object == 0 ? 1 : 0;
    grasp.face = 5;
    for (std::size_t i = 0; i < 9; ++i) grasp.quality[i] = normal(random);
    result.grasps.push_back(grasp);
  }
  result.report.stages = {{"scene", 10, 2, 0.5}};
  result.report.rejected = {{"too wide", 3}};
  result.report.notes = {"a note"};
  result.report.seed = 42;
  return result;
}

TEST(PlanConversion, BoxesOfAllObjectsStandOneAfterTheOther) {
  std::mt19937_64 random(3);
  const plan_response_t message = toMessage(twoObjects(random), "an id", "camera");
  ASSERT_EQ(message.num_boxes, 3);
  EXPECT_EQ(message.boxes[0].parent, -1);
  EXPECT_EQ(message.boxes[1].parent, 0);
  EXPECT_EQ(message.boxes[2].parent, -1);
  EXPECT_FALSE(message.boxes[0].leaf);
  EXPECT_TRUE(message.boxes[1].leaf);
  EXPECT_EQ(message.boxes[2].object, 1);
  EXPECT_EQ(message.boxes[1].points, 3);
  EXPECT_EQ(message.boxes[1].stop_reason, "few points");
  EXPECT_EQ(message.grasps[0].box, 2) << "the only box of the second object";
  EXPECT_EQ(message.grasps[1].box, 1) << "the second box of the first object";
}

// The quaternion in the message turns vectors as the pose does, and is the one with w >= 0.
TEST(PlanConversion, GraspsKeepTheirNumbers) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 50; ++i) {
    const PlanResult result = twoObjects(random);
    const grasp_t message = toMessage(result, "", "").grasps[0];
    const Grasp& grasp = result.grasps[0];
    const double* q = message.palm_quaternion_wxyz;
    const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
    EXPECT_GE(q[0], 0.0);
    EXPECT_TRUE(rotation.toRotationMatrix().isApprox(grasp.X_CP.linear(), 1e-12));
    EXPECT_EQ(Vector3d(message.palm_position_m), grasp.X_CP.translation());
    EXPECT_THAT(message.joints_rad, ElementsAre(0.1, 0.2, 0.3, 0.4));
    EXPECT_TRUE(std::equal(grasp.quality.begin(), grasp.quality.end(), message.quality));
    EXPECT_EQ(message.score, grasp.score);
    EXPECT_EQ(message.face, 5);
  }
}

// An answer in the robot's frame is the same answer moved; tool and palm keep their distance.
TEST(PlanConversion, AnswersMoveIntoTheRobotsFrame) {
  std::mt19937_64 random(7);
  PlanResult result = twoObjects(random);
  for (Grasp& grasp : result.grasps) {
    grasp.X_CP_pregrasp = makePose(grasp.X_CP.linear(), {1, 2, 3});
    grasp.X_CP_lift = makePose(grasp.X_CP.linear(), {4, 5, 6});
    for (SurfaceContact& contact : grasp.contacts) contact.p_C = {0.1, 0.2, 0.3};
    grasp.approach_C = grasp.X_CP.linear().col(2);
  }
  const plan_response_t in_cloud = toMessage(result, "id", "camera");
  const Pose X_RC = test::randomPose(random), X_TP = test::randomPose(random);
  result.X_AC = X_RC;
  result.X_TP = X_TP;
  result.frame = "arm";
  const plan_response_t in_robot = toMessage(result, "id", "camera");
  EXPECT_EQ(in_cloud.frame, "camera");
  EXPECT_EQ(in_robot.frame, "arm");
  const auto pose = [](const double* p, const double* q) {
    return makePose(Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix(), Vector3d(p));
  };
  const auto same = [](const Pose& a, const Pose& b) { return a.isApprox(b, 1e-9); };
  for (std::size_t i = 0; i < 2; ++i) {
    const grasp_t &c = in_cloud.grasps[i], &r = in_robot.grasps[i];
    const auto palm = [&](const grasp_t& g, const double* p) { return pose(p, g.palm_quaternion_wxyz); };
    const auto tool = [&](const grasp_t& g, const double* p) { return pose(p, g.tool_quaternion_wxyz); };
    EXPECT_TRUE(same(X_RC * palm(c, c.palm_position_m), palm(r, r.palm_position_m)));
    EXPECT_TRUE(same(X_RC * palm(c, c.pregrasp_position_m), palm(r, r.pregrasp_position_m)));
    EXPECT_TRUE(same(X_RC * palm(c, c.lift_position_m), palm(r, r.lift_position_m)));
    EXPECT_TRUE(same(tool(c, c.tool_position_m), palm(c, c.palm_position_m))) << "no tool was told of";
    EXPECT_TRUE(same(tool(r, r.tool_position_m) * X_TP, palm(r, r.palm_position_m)));
    EXPECT_TRUE(same(tool(r, r.tool_pregrasp_position_m) * X_TP, palm(r, r.pregrasp_position_m)));
    EXPECT_TRUE(same(tool(r, r.tool_lift_position_m) * X_TP, palm(r, r.lift_position_m)));
    EXPECT_TRUE((X_RC * Vector3d(0.1, 0.2, 0.3)).isApprox(Vector3d(r.contacts[1].position_m), 1e-9));
    EXPECT_TRUE((X_RC.linear() * Vector3d(c.approach)).isApprox(Vector3d(r.approach), 1e-9));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const box_t &c = in_cloud.boxes[i], &r = in_robot.boxes[i];
    EXPECT_TRUE(same(X_RC * pose(c.center_m, c.quaternion_wxyz), pose(r.center_m, r.quaternion_wxyz)));
  }
}

TEST(PlanConversion, ReportAndOutcomeAreThere) {
  std::mt19937_64 random(5);
  const plan_response_t message = toMessage(twoObjects(random), "an id", "camera");
  EXPECT_EQ(outcomeName(message.outcome), "grasps");
  EXPECT_EQ(message.request_id, "an id");
  EXPECT_EQ(message.frame, "camera");
  EXPECT_EQ(message.model_version, "0123abcd");
  ASSERT_EQ(message.num_stages, 1);
  EXPECT_EQ(message.stages[0].num_in, 10);
  EXPECT_EQ(message.stages[0].num_out, 2);
  ASSERT_EQ(message.num_rejected, 1);
  EXPECT_EQ(message.rejected[0].reason, "too wide");
  EXPECT_EQ(message.rejected[0].count, 3);
  EXPECT_EQ(message.seed, 42);
  EXPECT_EQ(decoded<plan_response_t>(encoded(message)).notes, message.notes);
}

TEST(PlanConversion, OutcomesHaveNames) {
  EXPECT_EQ(outcomeName(plan_response_t::OVERLOADED), "overloaded");
  EXPECT_EQ(outcomeName(plan_response_t::INTERNAL_ERROR), "internal_error");
  EXPECT_EQ(outcomeName(plan_response_t::NO_GRASP), "no_grasp");
  EXPECT_EQ(outcomeName(99), "unknown");
}

}  // namespace
}  // namespace boxgrasp
