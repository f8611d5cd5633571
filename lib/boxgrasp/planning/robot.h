// The robot that carries the hand: where its camera is, from where it may come, where it may be.
#pragma once

#include <array>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "boxgrasp/hand/kinematics.h"

namespace boxgrasp {

// In which frame the numbers of an answer are.
enum class AnswerFrame { cloud, robot };

// Frame R is the robot's, T that of its tool: whatever its controller is told poses of, often the wrist's
// flange. Numbers stand as in the configuration file.
struct RobotOptions {
  // Name of R, for answers in it.
  std::string frame = "robot";
  AnswerFrame answer_frame = AnswerFrame::cloud;
  // X_RC, the frame of the clouds in that of the robot. As it stands: clouds come in R. A camera that moves
  // with the arm is given with each request.
  std::array<double, 3> camera_position_m{0, 0, 0};
  std::array<double, 4> camera_quaternion_wxyz{1, 0, 0, 0};
  // X_TP, the palm in the frame of the tool. As it stands: the controller is told the palm's poses.
  std::array<double, 3> palm_position_m{0, 0, 0};
  std::array<double, 4> palm_quaternion_wxyz{1, 0, 0, 0};
  // Direction of gravity in R, for requests that do not give it; zeros: unknown.
  std::array<double, 3> gravity{0, 0, 0};
  // The hand comes along this direction in R, or leans from it by so much at most; pi: from anywhere.
  std::array<double, 3> approach{0, 0, -1};
  double approach_cone_rad = std::numbers::pi;
  // The palm's origin stays in this box of R before the grasp, in it, and lifted.
  std::array<double, 3> workspace_min_m{-kUnbounded, -kUnbounded, -kUnbounded};
  std::array<double, 3> workspace_max_m{kUnbounded, kUnbounded, kUnbounded};
  // No part of the hand enters these boxes of R, x y z of one corner and of the opposite one, on its way in,
  // closing, or lifted.
  std::vector<std::array<double, 6>> forbidden_m;
  // How far a grasped object is lifted: against gravity, or back along the approach where gravity is unknown.
  double lift_m = 0.10;
  void validate() const;

  static constexpr double kUnbounded = std::numeric_limits<double>::infinity();
};

// The hand comes along this direction, or leans from it by so much at most.
struct ApproachCone {
  Vector3d direction_R = -Vector3d::UnitZ();  // any length
  double half_angle_rad = std::numbers::pi;
};

// What a request says of its robot in place of the options; forbidden boxes come on top of theirs.
struct RobotRequest {
  std::optional<Pose> X_RC;
  std::optional<AnswerFrame> answer_frame;
  std::optional<ApproachCone> approach;
  std::optional<Eigen::AlignedBox3d> workspace_R;
  std::vector<Eigen::AlignedBox3d> forbidden_R;
};

// The hand on its way: both poses have the rotation of the grasp.
struct GraspMotion {
  Pose X_CP_pregrasp, X_CP, X_CP_lift;
  HandJoints pregrasp, closed;
};

// The robot of one plan.
class Robot {
 public:
  // Throws InputError for a request that cannot be.
  Robot(const RobotOptions& options, const RobotRequest& request);

  const Pose& X_RC() const { return X_RC_; }
  const Pose& X_TP() const { return X_TP_; }
  AnswerFrame answerFrame() const { return answer_frame_; }
  std::optional<Vector3d> gravity_C() const;  // unit; as configured

  bool restrictsApproach() const;
  bool restrictsReach() const;
  bool mayComeAlong(const Vector3d& approach_C) const;  // unit

  // Why the robot cannot make this motion; nullopt: it can. The fingers are tried open, closed, and in
  // `closing_steps` - 1 poses between, as for the clearance.
  std::optional<std::string_view> obstacle(const HandDescription& hand, const GraspMotion& motion,
                                           int closing_steps) const;

 private:
  bool inWorkspace(const Pose& X_CP) const;
  bool isForbidden(const HandDescription& hand, const GraspMotion& motion, int closing_steps) const;
  bool entersForbidden(const HandDescription& hand, const HandJoints& joints, const Pose& X_CP,
                       const Vector3d& way_C) const;

  Pose X_RC_, X_TP_;
  AnswerFrame answer_frame_;
  Vector3d gravity_R_;
  ApproachCone approach_;
  Eigen::AlignedBox3d workspace_R_;
  std::vector<Eigen::AlignedBox3d> forbidden_R_;
};

}  // namespace boxgrasp
