#include "commands.h"

#include <fmt/format.h>

#include <cmath>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/messaging/plan_conversion.h"
#include "boxgrasp/planning/default_model.h"
#include "boxgrasp/planning/grasp_planner.h"
#include "boxgrasp/planning/planner_config.h"
#include "boxgrasp/rendering/picture.h"
#include "boxgrasp/viewer/plan_page.h"
#include "plan_json.h"
#include "plan_text.h"
#include "remote.h"

namespace boxgrasp {
namespace {

Eigen::AlignedBox3d boxOf(const std::array<double, 6>& corners) {
  return {Vector3d(corners.data()), Vector3d(corners.data() + 3)};
}

Pose poseOf(const std::array<double, 7>& numbers) {
  const Eigen::Quaterniond rotation(numbers[3], numbers[4], numbers[5], numbers[6]);
  requireOption(std::abs(rotation.norm() - 1) < 1e-3, "--camera-pose",
                fmt::format("{}", fmt::join(numbers, " ")), "X Y Z and a unit quaternion QW QX QY QZ");
  return makePose(rotation.normalized().toRotationMatrix(), Vector3d(numbers.data()));
}

void putRobot(const RobotFlags& flags, PlanRequest& request) {
  if (flags.table) {
    const Vector3d normal_C(flags.table->data() + 3);
    request.table_C = Plane{normal_C, normal_C.dot(Vector3d(flags.table->data()))};
  }
  RobotRequest& robot = request.robot;
  robot.answer_frame = flags.answer_frame;
  if (flags.camera_pose) robot.X_RC = poseOf(*flags.camera_pose);
  if (flags.approach) robot.approach = {Vector3d(flags.approach->data()), flags.approach_cone_rad};
  if (flags.workspace) robot.workspace_R = boxOf(*flags.workspace);
  for (const auto& corners : flags.forbidden) robot.forbidden_R.push_back(boxOf(corners));
}

PlanRequest requestOf(const PlanCommand& command) {
  LoadedCloud loaded = readCloud(command.file, command.read);
  fmt::print(stderr, "boxgrasp: {}: {} points ({})\n", command.file.string(), loaded.cloud_C.size(),
             loaded.format);
  PlanRequest request;
  request.cloud_C = std::move(loaded.cloud_C);
  request.top_k = command.top;
  request.friction = command.friction;
  request.object = command.object;
  if (command.gravity) request.gravity_C = Vector3d(command.gravity->data());
  for (const std::array<double, 3>& viewpoint : command.viewpoints)
    request.viewpoints_C.push_back(Vector3d(viewpoint.data()));
  if (request.viewpoints_C.empty() && loaded.viewpoint_C) request.viewpoints_C = {*loaded.viewpoint_C};
  putRobot(command.robot, request);
  return request;
}

GraspPlanner plannerOf(const PlanCommand& command) {
  const HandDescription hand = handOrBarrett(command.hand);
  return {hand, modelOrDefault(command.model, hand),
          command.config ? readPlannerOptions(*command.config) : PlannerOptions{}};
}

StopToken deadlineOf(const PlanCommand& command) {
  if (command.deadline_s <= 0) return {};
  return StopToken(StopToken::Clock::now() + std::chrono::duration_cast<StopToken::Clock::duration>(
                                                 std::chrono::duration<double>(command.deadline_s)));
}

void draw(const PlanCommand& command, const PlanResult& result, const PlanTrace& trace,
          const HandDescription& hand) {
  const std::string title = command.file.filename().string();
  if (command.picture && !result.objects.empty()) {
    writePlanPicture(result, trace, hand, *command.picture, {.title = title});
    fmt::print(stderr, "boxgrasp: picture written to {}\n", command.picture->string());
  }
  if (command.html) {
    writePlanPage(planScene(result, trace, hand, {.title = title}), *command.html);
    fmt::print(stderr, "boxgrasp: page written to {}\n", command.html->string());
  }
}

// Plans here, and draws the plan where that is asked for.
plan_response_t planHere(const PlanCommand& command, PlanRequest request) {
  const GraspPlanner planner = plannerOf(command);
  PlanTrace trace;
  const PlanResult result =
      planner.plan(std::move(request), deadlineOf(command), command.draws() ? &trace : nullptr);
  draw(command, result, trace, planner.hand());
  return toMessage(result, "", command.frame);
}

plan_response_t planThere(const PlanCommand& command, const PlanRequest& request) {
  const plan_response_t answer =
      Remote(command.lcm_url).plan({request, command.frame, command.deadline_s, command.request_id});
  if (answer.outcome == plan_response_t::GRASPS)
    fmt::print(stderr,
               "boxgrasp: say how a grasp went with: boxgrasp feedback {} INDEX --succeeded or --failed\n",
               answer.request_id);
  return answer;
}

plan_response_t answerTo(const PlanCommand& command) {
  PlanRequest request = requestOf(command);
  if (command.local) return planHere(command, std::move(request));
  plan_response_t answer = planThere(command, request);
  // A drawing needs what the planner saw on its way, which does not go over the wire: the same plan, made
  // again.
  if (command.draws() && planHere(command, std::move(request)).model_version != answer.model_version)
    fmt::print(stderr,
               "boxgrasp: the server ranks with model {}; the drawing shows this program's own ranking\n",
               answer.model_version);
  return answer;
}

int exitCodeOf(const plan_response_t& answer) {
  switch (answer.outcome) {
    case plan_response_t::GRASPS:
      return kDone;
    case plan_response_t::BAD_INPUT:
      return kBadInput;
    case plan_response_t::DEADLINE:
      return kDeadlinePassed;
    case plan_response_t::INTERNAL_ERROR:
      return kInternalError;
    default:
      return kNothingFound;
  }
}

// The answer goes to stdout as it was asked for; a plan that failed says why on stderr too.
int conclude(const PlanCommand& command, const plan_response_t& answer, const std::string& text) {
  fmt::print("{}", command.json ? jsonText(planJson(answer)) + "\n" : text);
  if (answer.outcome != plan_response_t::GRASPS) fmt::print(stderr, "boxgrasp: {}\n", answer.message);
  return exitCodeOf(answer);
}

}  // namespace

int runPlan(const PlanCommand& command) {
  const plan_response_t answer = answerTo(command);
  return conclude(command, answer, answer.outcome == plan_response_t::GRASPS ? planText(answer) : "");
}

Json plannedJson(const PlanCommand& command, int& exit_code) {
  const plan_response_t answer = answerTo(command);
  if (answer.outcome != plan_response_t::GRASPS) fmt::print(stderr, "boxgrasp: {}\n", answer.message);
  exit_code = exitCodeOf(answer);
  return planJson(answer);
}

int runExplain(const PlanCommand& command) {
  const plan_response_t answer = answerTo(command);
  return conclude(command, answer, explanationText(answer));
}

int runShow(const PlanCommand& command) {
  const plan_response_t answer = planHere(command, requestOf(command));
  return conclude(command, answer, fmt::format("{}\n", answer.message));
}

int runStatus(const std::string& lcm_url, bool json) {
  const status_t status = Remote(lcm_url).status();
  fmt::print("{}", json ? jsonText(statusJson(status)) + "\n" : statusText(status));
  return kDone;
}

}  // namespace boxgrasp
