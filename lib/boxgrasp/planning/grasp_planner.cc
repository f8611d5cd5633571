#include "boxgrasp/planning/grasp_planner.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "boxgrasp/base/error.h"
#include "boxgrasp/planning/distinct.h"
#include "boxgrasp/planning/features.h"
#include "boxgrasp/planning/hypotheses.h"
#include "boxgrasp/planning/tally.h"

namespace boxgrasp {
namespace {

void rank(const Model& model, PlanResult& result, Tally& tally) {
  const StageTimer timer(tally, StageId::ranking);
  if (result.grasps.empty()) return;
  for (Grasp& grasp : result.grasps) {
    const double size_m = objectSize(result.objects[grasp.object]);
    const VectorXd inputs = networkInputs(model.features, grasp.quality, size_m);
    grasp.score = scores(model.ensemble, inputs.transpose())[0];
  }
  std::stable_sort(result.grasps.begin(), result.grasps.end(),
                   [](const Grasp& a, const Grasp& b) { return a.score > b.score; });
  tally.count(StageId::ranking, result.grasps.size(), result.grasps.size());
}

void keepDistinct(const PlannerOptions& options, int top_k, const StopToken& stop, std::vector<Grasp>& grasps,
                  Tally& tally) {
  const StageTimer timer(tally, StageId::distinct);
  if (grasps.empty()) return;
  const std::size_t before = grasps.size();
  grasps = distinctGrasps(std::move(grasps), top_k, options.merge_distance_m, options.merge_angle_rad, stop);
  tally.count(StageId::distinct, before, grasps.size());
}

void conclude(PlanResult& result, const Tally& tally) {
  result.outcome = result.grasps.empty() ? Outcome::no_grasp : Outcome::grasps;
  result.message = result.grasps.empty() ? whyNoGrasp(tally) : fmt::format("{} grasps", result.grasps.size());
}

void concludeStopped(PlanResult& result, const Stopped& stopped, const Tally& tally) {
  std::string_view reached = "validation";
  for (std::size_t i = 0; i < kStageCount; ++i) {
    if (tally[static_cast<StageId>(i)].reached) reached = stageText(static_cast<StageId>(i)).name;
  }
  const bool late = stopped.reason == StopReason::deadline;
  result.outcome = late ? Outcome::deadline : Outcome::cancelled;
  result.message = fmt::format("{} before the plan was done; the last stage begun was '{}'",
                               late ? "the deadline passed" : "the request was cancelled", reached);
  result.grasps.clear();
}

void report(PlanResult& result, const Tally& tally, double time_s) {
  for (std::size_t i = 0; i < kStageCount; ++i) {
    const auto id = static_cast<StageId>(i);
    if (tally[id].reached)
      result.report.stages.push_back(
          {std::string(stageText(id).name), tally[id].in, tally[id].out, tally[id].time_s});
  }
  result.report.rejected = tally.rejected();
  result.report.time_s = time_s;
}

}  // namespace

std::string_view describe(Outcome outcome) {
  switch (outcome) {
    case Outcome::grasps:
      return "grasps";
    case Outcome::no_grasp:
      return "no_grasp";
    case Outcome::bad_input:
      return "bad_input";
    case Outcome::deadline:
      return "deadline";
    case Outcome::cancelled:
      return "cancelled";
  }
  return "unknown";
}

void PlannerOptions::validate() const {
  validation.validate();
  scene.validate();
  clean.validate();
  decomposition.validate();
  faces.validate();
  image.validate();
  contours.validate();
  regions.validate();
  triplets.validate();
  configurations.validate();
  contacts.validate();
  clearance.validate();
  requireOption(merge_distance_m >= 0, "merge_distance_m", merge_distance_m, "at least 0");
  requireOption(merge_angle_rad >= 0, "merge_angle_rad", merge_angle_rad, "at least 0");
  requireOption(threads >= 0, "threads", threads, "at least 0");
}

GraspPlanner::GraspPlanner(HandDescription hand, Model model, PlannerOptions options)
    : hand_(std::move(hand)), model_(std::move(model)), options_(std::move(options)) {
  options_.validate();
  model_.ensemble.validate();
  const auto features = static_cast<int>(model_.features.size());
  requireOption(model_.ensemble.inputs() == features, "the model's number of inputs",
                model_.ensemble.inputs(), "that of its features");
  networkInputs(model_.features, QualityMeasures{}, 1.0);
}

PlanResult GraspPlanner::plan(const PlanRequest& request, const StopToken& stop, PlanTrace* trace) const {
  const auto start = std::chrono::steady_clock::now();
  PlanResult result;
  result.model_version = model_.version;
  result.report.seed = options_.scene.seed;
  Tally tally;
  try {
    stop.check();
    requireOption(request.top_k >= 0, "top_k", request.top_k, "at least 0");
    findHypotheses(hand_, options_, request, stop, trace, result, tally);
    rank(model_, result, tally);
    keepDistinct(options_, request.top_k, stop, result.grasps, tally);
    conclude(result, tally);
  } catch (const Stopped& stopped) {
    concludeStopped(result, stopped, tally);
  } catch (const InputError& error) {
    result.outcome = Outcome::bad_input;
    result.message = error.what();
  }
  report(result, tally, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return result;
}

}  // namespace boxgrasp
