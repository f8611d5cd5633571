#include "boxgrasp/messaging/plan_conversion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "boxgrasp/base/error.h"
#include "boxgrasp/messaging/cloud_conversion.h"

namespace boxgrasp {
namespace {

static_assert(plan_response_t::GRASPS == static_cast<int>(Outcome::grasps));
static_assert(plan_response_t::NO_GRASP == static_cast<int>(Outcome::no_grasp));
static_assert(plan_response_t::BAD_INPUT == static_cast<int>(Outcome::bad_input));
static_assert(plan_response_t::DEADLINE == static_cast<int>(Outcome::deadline));
static_assert(plan_response_t::CANCELLED == static_cast<int>(Outcome::cancelled));

constexpr double kQuaternionRounding = 1e-3;  // four digits of a quaternion are enough

void put(const Vector3d& v, double (&out)[3]) { std::copy_n(v.data(), 3, out); }

void put(const Matrix3d& R, double (&wxyz)[4]) {
  Eigen::Quaterniond q(R);
  if (q.w() < 0) q.coeffs() *= -1.0;
  const std::array<double, 4> values{q.w(), q.x(), q.y(), q.z()};
  std::copy(values.begin(), values.end(), wxyz);
}

void put(const HandJoints& joints, double (&out)[4]) {
  out[0] = joints.spread;
  std::copy(joints.inner.begin(), joints.inner.end(), out + 1);
}

void putMotion(const PlanResult& result, const Grasp& grasp, grasp_t& message) {
  const Pose X_PT = result.X_TP.inverse();
  const Pose X_AP = result.X_AC * grasp.X_CP, X_AT = X_AP * X_PT;
  const Pose X_AP_pregrasp = result.X_AC * grasp.X_CP_pregrasp, X_AP_lift = result.X_AC * grasp.X_CP_lift;
  put(X_AP.translation(), message.palm_position_m);
  put(X_AP.linear(), message.palm_quaternion_wxyz);
  put(X_AP_pregrasp.translation(), message.pregrasp_position_m);
  put(X_AP_lift.translation(), message.lift_position_m);
  put(X_AT.translation(), message.tool_position_m);
  put(X_AT.linear(), message.tool_quaternion_wxyz);
  put(X_AP_pregrasp * X_PT.translation(), message.tool_pregrasp_position_m);
  put(X_AP_lift * X_PT.translation(), message.tool_lift_position_m);
}

grasp_t toMessage(const PlanResult& result, const Grasp& grasp, int first_box) {
  grasp_t message{};
  message.score = grasp.score;
  putMotion(result, grasp, message);
  put(grasp.joints, message.joints_rad);
  put(grasp.pregrasp, message.pregrasp_rad);
  for (int finger = 0; finger < 3; ++finger) {
    put(result.X_AC * grasp.contacts[finger].p_C, message.contacts[finger].position_m);
    put(result.X_AC.linear() * grasp.contacts[finger].normal_C, message.contacts[finger].normal);
    message.contacts[finger].seen = grasp.contacts[finger].seen;
  }
  put(result.X_AC.linear() * grasp.approach_C, message.approach);
  std::copy(grasp.quality.begin(), grasp.quality.end(), message.quality);
  message.object = grasp.object;
  message.box = first_box + grasp.box;
  message.face = grasp.face;
  return message;
}

void put(const BoxShape& shape, const Pose& X_AC, box_t& message) {
  message.shape = describe(shape.kind);
  put(X_AC * shape.center_C, message.shape_center_m);
  put(X_AC.linear() * shape.axis_C, message.shape_axis);
  message.shape_radius_m = shape.radius_m;
}

box_t toMessage(const BoxNode& node, const Pose& X_AC, int object, int first_box) {
  box_t message{};
  const Pose X_AB = X_AC * node.box.X_CB;
  put(X_AB.translation(), message.center_m);
  put(X_AB.linear(), message.quaternion_wxyz);
  put(node.box.extents, message.extents_m);
  message.points = static_cast<int>(node.points.size());
  message.parent = node.parent < 0 ? -1 : first_box + node.parent;
  message.leaf = node.leaf();
  message.theta = node.theta;
  message.stop_reason = node.stop_reason;
  message.object = object;
  return message;
}

// Fills in the boxes and returns for each object where its own begin.
std::vector<int> putBoxes(const PlanResult& result, plan_response_t& message) {
  std::vector<int> first;
  for (std::size_t object = 0; object < result.objects.size(); ++object) {
    first.push_back(static_cast<int>(message.boxes.size()));
    const auto& nodes = result.objects[object].tree.nodes;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      message.boxes.push_back(toMessage(nodes[i], result.X_AC, static_cast<int>(object), first.back()));
      put(result.objects[object].shapeOf(i), result.X_AC, message.boxes.back());
    }
  }
  message.num_boxes = static_cast<int>(message.boxes.size());
  return first;
}

void putReport(const PlanReport& report, plan_response_t& message) {
  for (const Stage& stage : report.stages) {
    stage_t& row = message.stages.emplace_back();
    row.name = stage.name;
    row.num_in = static_cast<std::int64_t>(stage.in);
    row.num_out = static_cast<std::int64_t>(stage.out);
    row.time_s = stage.time_s;
  }
  for (const auto& [reason, count] : report.rejected) {
    rejection_t& row = message.rejected.emplace_back();
    row.reason = reason;
    row.count = static_cast<std::int64_t>(count);
  }
  message.notes = report.notes;
  message.num_stages = static_cast<int>(message.stages.size());
  message.num_rejected = static_cast<int>(message.rejected.size());
  message.num_notes = static_cast<int>(message.notes.size());
  message.seed = static_cast<std::int64_t>(report.seed);
  message.time_s = report.time_s;
}

Vector3d finite(const double (&values)[3], std::string_view member) {
  const Vector3d v(values[0], values[1], values[2]);
  if (!v.allFinite())
    throw InputError(fmt::format("request: {} is ({}, {}, {}), but must be three finite numbers", member,
                                 v.x(), v.y(), v.z()));
  return v;
}

static_assert(plan_request_t::CLOUD_FRAME == 1 + static_cast<int>(AnswerFrame::cloud));
static_assert(plan_request_t::ROBOT_FRAME == 1 + static_cast<int>(AnswerFrame::robot));

void put(const Eigen::AlignedBox3d& box, double (&min_m)[3], double (&max_m)[3]) {
  put(box.min(), min_m);
  put(box.max(), max_m);
}

void putRobot(const RobotRequest& robot, plan_request_t& message) {
  message.answer_frame = robot.answer_frame
                             ? static_cast<std::int8_t>(1 + static_cast<int>(*robot.answer_frame))
                             : plan_request_t::SERVERS_FRAME;
  message.has_camera_pose = robot.X_RC.has_value();
  if (robot.X_RC) {
    put(robot.X_RC->translation(), message.camera_position_m);
    put(robot.X_RC->linear(), message.camera_quaternion_wxyz);
  }
  message.has_approach = robot.approach.has_value();
  if (robot.approach) {
    put(robot.approach->direction_R, message.approach);
    message.approach_cone_rad = robot.approach->half_angle_rad;
  }
  message.has_workspace = robot.workspace_R.has_value();
  if (robot.workspace_R) put(*robot.workspace_R, message.workspace_min_m, message.workspace_max_m);
  for (const Eigen::AlignedBox3d& box : robot.forbidden_R) {
    region_t& region = message.forbidden.emplace_back();
    put(box, region.min_m, region.max_m);
  }
  message.num_forbidden = static_cast<int>(message.forbidden.size());
}

Matrix3d rotation(const double (&wxyz)[4], std::string_view member) {
  const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!(std::abs(q.norm() - 1) < kQuaternionRounding))
    throw InputError(fmt::format("request: {} is ({}), but must be a unit quaternion w x y z", member,
                                 fmt::join(wxyz, ", ")));
  return q.normalized().toRotationMatrix();
}

// Sides may be infinite; the planner refuses boxes that are inside out.
Eigen::AlignedBox3d box(const double (&min_m)[3], const double (&max_m)[3]) {
  return {Vector3d(min_m), Vector3d(max_m)};
}

RobotRequest robotOf(const plan_request_t& message) {
  RobotRequest robot;
  if (message.answer_frame < 0 || message.answer_frame > plan_request_t::ROBOT_FRAME)
    throw InputError(
        fmt::format("request: answer_frame is {}, but must be 0 (the server's), 1 (the cloud's) or "
                    "2 (the robot's)",
                    message.answer_frame));
  if (message.answer_frame != plan_request_t::SERVERS_FRAME)
    robot.answer_frame = static_cast<AnswerFrame>(message.answer_frame - 1);
  if (message.has_camera_pose)
    robot.X_RC = makePose(rotation(message.camera_quaternion_wxyz, "camera_quaternion_wxyz"),
                          finite(message.camera_position_m, "camera_position_m"));
  if (message.has_approach)
    robot.approach = {finite(message.approach, "approach"), message.approach_cone_rad};
  if (message.has_workspace) robot.workspace_R = box(message.workspace_min_m, message.workspace_max_m);
  for (const region_t& region : message.forbidden)
    robot.forbidden_R.push_back(box(region.min_m, region.max_m));
  return robot;
}

// The plane through the point.
Plane tableOf(const plan_request_t& message) {
  const Vector3d normal_C = finite(message.table_normal, "table_normal");
  return {normal_C, normal_C.dot(finite(message.table_point_m, "table_point_m"))};
}

}  // namespace

plan_request_t toMessage(const PlanRequest& request, const RequestEnvelope& envelope) {
  plan_request_t message{};
  message.utime = envelope.utime;
  message.request_id = envelope.request_id;
  message.cloud = toMessage(request.cloud_C, envelope.frame);
  message.top_k = request.top_k == 0 ? -1 : request.top_k;
  message.deadline_s = envelope.deadline_s;
  message.friction = request.friction;
  message.object = request.object;
  message.has_gravity = request.gravity_C.has_value();
  if (request.gravity_C) put(*request.gravity_C, message.gravity);
  for (const Vector3d& viewpoint_C : request.viewpoints_C) {
    message.viewpoints.emplace_back();
    put(viewpoint_C, message.viewpoints.back().position_m);
  }
  message.num_viewpoints = static_cast<int>(message.viewpoints.size());
  message.has_table = request.table_C.has_value();
  if (request.table_C) {
    const Vector3d& normal_C = request.table_C->normal_C;
    put(normal_C, message.table_normal);
    put(request.table_C->offset_m / normal_C.squaredNorm() * normal_C, message.table_point_m);
  }
  putRobot(request.robot, message);
  return message;
}

PlanRequest fromMessage(const plan_request_t& message) {
  PlanRequest request;
  if (message.top_k < -1)
    throw InputError(fmt::format("request: top_k is {}, but must be at least -1 (all)", message.top_k));
  if (message.top_k != 0) request.top_k = std::max(message.top_k, 0);
  if (!std::isfinite(message.friction) || message.friction < 0)
    throw InputError(
        fmt::format("request: friction is {}, but must be a coefficient above 0, or 0 for the default",
                    message.friction));
  if (message.friction > 0) request.friction = message.friction;
  request.object = message.object;
  if (message.has_gravity) request.gravity_C = finite(message.gravity, "gravity");
  for (const viewpoint_t& viewpoint : message.viewpoints)
    request.viewpoints_C.push_back(finite(viewpoint.position_m, "viewpoints.position_m"));
  if (message.has_table) request.table_C = tableOf(message);
  request.robot = robotOf(message);
  request.cloud_C = fromMessage(message.cloud);
  return request;
}

plan_response_t toMessage(const PlanResult& result, const std::string& request_id, const std::string& frame) {
  plan_response_t message = refusal(static_cast<std::int8_t>(result.outcome), result.message, request_id,
                                    result.frame.empty() ? frame : result.frame);
  message.model_version = result.model_version;
  const std::vector<int> first_box = putBoxes(result, message);
  for (const Grasp& grasp : result.grasps)
    message.grasps.push_back(toMessage(result, grasp, first_box.at(grasp.object)));
  message.num_grasps = static_cast<int>(message.grasps.size());
  putReport(result.report, message);
  return message;
}

plan_response_t refusal(std::int8_t outcome, const std::string& message, const std::string& request_id,
                        const std::string& frame) {
  plan_response_t response{};
  response.outcome = outcome;
  response.message = message;
  response.request_id = request_id;
  response.frame = frame;
  return response;
}

std::string_view outcomeName(std::int8_t outcome) {
  if (outcome == plan_response_t::OVERLOADED) return "overloaded";
  if (outcome == plan_response_t::INTERNAL_ERROR) return "internal_error";
  return describe(static_cast<Outcome>(outcome));
}

std::int64_t utimeNow() {
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

}  // namespace boxgrasp
