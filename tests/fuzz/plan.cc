// A request from its bytes to its answer: whatever the cloud is, the planner answers.
#include "boxgrasp/messaging/codec.h"
#include "boxgrasp/messaging/plan_conversion.h"
#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/planning/default_model.h"
#include "boxgrasp/planning/grasp_planner.h"
#include "fuzz_target.h"

namespace boxgrasp::fuzz {
namespace {

constexpr std::size_t kFingerprint = 8;
constexpr std::chrono::seconds kPatience{2};

GraspPlanner planner() {
  PlannerOptions options;
  options.threads = 1;
  return {barrettHand(), modelOrDefault(std::nullopt), options};
}

}  // namespace

void feed(Bytes bytes) {
  static const GraspPlanner kPlanner = planner();
  static const auto fingerprint = encoded(plan_request_t{});
  std::vector<std::uint8_t> message(bytes.begin(), bytes.end());
  std::copy_n(fingerprint.begin(), std::min(kFingerprint, message.size()), message.begin());
  accepts([&] {
    const PlanRequest request = fromMessage(decoded<plan_request_t>(message));
    const StopToken stop(StopToken::Clock::now() + kPatience);
    encoded(toMessage(kPlanner.plan(request, stop), "id", "frame"));
  });
}

std::vector<std::string> seeds() {
  std::vector<std::string> result;
  for (const char* name : {"paper_cup", "mug"}) {
    PlanRequest request;
    request.cloud_C = sampleSurface(parametricObject(name), 400, 1);
    request.table_C = Plane{Vector3d::UnitZ(), 0.0};
    request.robot.X_RC = Pose::Identity();
    request.robot.approach = {-Vector3d::UnitZ(), 1.0};
    request.robot.workspace_R = Eigen::AlignedBox3d(Vector3d(-1, -1, -1), Vector3d(1, 1, 1));
    request.robot.forbidden_R = {Eigen::AlignedBox3d(Vector3d(0.1, -1, -1), Vector3d(0.2, 1, 1))};
    result.push_back(textOf(encoded(toMessage(request, {name, "camera", 0.0, 1}))));
  }
  return result;
}

}  // namespace boxgrasp::fuzz
