#include "boxgrasp/planning/robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "boxgrasp/base/error.h"
#include "boxgrasp/geometry/separation.h"

namespace boxgrasp {
namespace {

constexpr double kWorld_m = 100.0;  // no robot reaches so far: bounds forbidden boxes that have no end

Vector3d vector(const std::array<double, 3>& values) { return Vector3d(values.data()); }

bool isRotation(const std::array<double, 4>& wxyz) {
  const double norm = Eigen::Map<const Eigen::Vector4d>(wxyz.data()).norm();
  return norm > 0.9 && norm < 1.1;
}

Pose pose(const std::array<double, 3>& position_m, const std::array<double, 4>& wxyz) {
  const Eigen::Quaterniond rotation(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  return makePose(rotation.normalized().toRotationMatrix(), vector(position_m));
}

// Of one corner and the opposite one, in any order.
Eigen::AlignedBox3d boxOf(const std::array<double, 6>& corners) {
  Eigen::AlignedBox3d box(Vector3d(corners.data()));
  return box.extend(Vector3d(corners.data() + 3));
}

bool isNumber(double value) { return !std::isnan(value); }

void requireFinite(std::string_view field, const std::array<double, 3>& values) {
  requireOption(vector(values).allFinite(), field, fmt::format("{}", fmt::join(values, " ")),
                "three finite numbers");
}

void requireRotation(std::string_view field, const std::array<double, 4>& values) {
  requireOption(isRotation(values), field, fmt::format("{}", fmt::join(values, " ")),
                "a unit quaternion w x y z");
}

void requireBox(std::string_view field, const Eigen::AlignedBox3d& box) {
  requireOption((box.min().array() < box.max().array()).all(), field,
                fmt::format("from {} to {}", fmt::join(box.min(), " "), fmt::join(box.max(), " ")),
                "a box whose every side is longer than 0");
}

void requireCone(const ApproachCone& cone) {
  requireOption(cone.direction_R.allFinite() && cone.direction_R.norm() > 0, "approach",
                fmt::format("{}", fmt::join(cone.direction_R, " ")),
                "a direction: three finite numbers, not all 0");
  requireOption(cone.half_angle_rad >= 0 && cone.half_angle_rad <= std::numbers::pi, "approach_cone_rad",
                cone.half_angle_rad, "in [0, pi]");
}

}  // namespace

void RobotOptions::validate() const {
  requireFinite("camera_position_m", camera_position_m);
  requireRotation("camera_quaternion_wxyz", camera_quaternion_wxyz);
  requireFinite("palm_position_m", palm_position_m);
  requireRotation("palm_quaternion_wxyz", palm_quaternion_wxyz);
  requireFinite("gravity", gravity);
  requireCone({vector(approach), approach_cone_rad});
  requireBox("workspace_min_m, workspace_max_m", {vector(workspace_min_m), vector(workspace_max_m)});
  for (const auto& corners : forbidden_m) {
    requireOption(std::ranges::all_of(corners, isNumber), "forbidden_m",
                  fmt::format("{}", fmt::join(corners, " ")), "two corners of a box each, six numbers");
    requireBox("forbidden_m", boxOf(corners));
  }
  requireOption(lift_m >= 0 && lift_m <= 10, "lift_m", lift_m, "in [0, 10]");
}

Robot::Robot(const RobotOptions& options, const RobotRequest& request)
    : X_RC_(request.X_RC.value_or(pose(options.camera_position_m, options.camera_quaternion_wxyz))),
      X_TP_(pose(options.palm_position_m, options.palm_quaternion_wxyz)),
      answer_frame_(request.answer_frame.value_or(options.answer_frame)),
      gravity_R_(vector(options.gravity)),
      approach_(request.approach.value_or(ApproachCone{vector(options.approach), options.approach_cone_rad})),
      workspace_R_(request.workspace_R.value_or(
          Eigen::AlignedBox3d(vector(options.workspace_min_m), vector(options.workspace_max_m)))),
      forbidden_R_(request.forbidden_R) {
  requireCone(approach_);
  requireBox("workspace", workspace_R_);
  for (const auto& corners : options.forbidden_m) forbidden_R_.push_back(boxOf(corners));
  const Eigen::AlignedBox3d world(Vector3d::Constant(-kWorld_m), Vector3d::Constant(kWorld_m));
  for (Eigen::AlignedBox3d& box : forbidden_R_) {
    requireBox("forbidden", box);
    box.clamp(world);
  }
  std::erase_if(forbidden_R_, [](const Eigen::AlignedBox3d& box) { return box.isEmpty(); });
}

std::optional<Vector3d> Robot::gravity_C() const {
  if (gravity_R_.isZero(0)) return std::nullopt;
  return X_RC_.linear().transpose() * gravity_R_.normalized();
}

bool Robot::restrictsApproach() const { return approach_.half_angle_rad < std::numbers::pi; }

bool Robot::restrictsReach() const {
  return workspace_R_.min().array().isFinite().any() || workspace_R_.max().array().isFinite().any() ||
         !forbidden_R_.empty();
}

bool Robot::mayComeAlong(const Vector3d& approach_C) const {
  const Vector3d come_R = X_RC_.linear() * approach_C;
  const Vector3d& allowed_R = approach_.direction_R;
  return std::atan2(come_R.cross(allowed_R).norm(), come_R.dot(allowed_R)) <= approach_.half_angle_rad;
}

bool Robot::inWorkspace(const Pose& X_CP) const { return workspace_R_.contains(X_RC_ * X_CP.translation()); }

bool Robot::entersForbidden(const HandDescription& hand, const HandJoints& joints, const Pose& X_CP,
                            const Vector3d& way_C) const {
  const HandGeometry geometry = forwardKinematics(hand, joints);
  const Pose X_RP = X_RC_ * X_CP;
  const Vector3d way_R = X_RC_.linear() * way_C;
  std::vector<Support> bodies{cylinderBetween(X_RP * Vector3d(0, 0, -geometry.palm_thickness),
                                              X_RP.translation(), geometry.palm_radius)};
  for (const Capsule& link : geometry.links)
    bodies.push_back(capsuleBetween(X_RP * link.a, X_RP * link.b, link.radius));
  return std::ranges::any_of(bodies, [&](const Support& body) {
    return std::ranges::any_of(forbidden_R_, [&](const Eigen::AlignedBox3d& box) {
      return !apart(swept(body, way_R), alignedBox(box));
    });
  });
}

bool Robot::isForbidden(const HandDescription& hand, const GraspMotion& motion, int closing_steps) const {
  const Vector3d way_in_C = motion.X_CP.translation() - motion.X_CP_pregrasp.translation();
  const Vector3d lift_C = motion.X_CP_lift.translation() - motion.X_CP.translation();
  if (entersForbidden(hand, motion.pregrasp, motion.X_CP_pregrasp, way_in_C)) return true;
  for (int step = 1; step < closing_steps; ++step) {
    HandJoints between = motion.pregrasp;
    for (std::size_t i = 0; i < between.inner.size(); ++i)
      between.inner[i] = std::lerp(between.inner[i], motion.closed.inner[i], step / double(closing_steps));
    if (entersForbidden(hand, between, motion.X_CP, Vector3d::Zero())) return true;
  }
  return entersForbidden(hand, motion.closed, motion.X_CP, lift_C);
}

std::optional<std::string_view> Robot::obstacle(const HandDescription& hand, const GraspMotion& motion,
                                                int closing_steps) const {
  if (!inWorkspace(motion.X_CP)) return "palm outside the robot's workspace";
  if (!inWorkspace(motion.X_CP_pregrasp)) return "palm outside the robot's workspace before the grasp";
  if (!inWorkspace(motion.X_CP_lift)) return "palm outside the robot's workspace when lifted";
  if (!forbidden_R_.empty() && isForbidden(hand, motion, closing_steps))
    return "hand enters a forbidden region";
  return std::nullopt;
}

}  // namespace boxgrasp
