#include "boxgrasp/planning/grasp_planner.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "boxgrasp/base/error.h"
#include "boxgrasp/planning/distinct.h"
#include "boxgrasp/planning/features.h"
#include "boxgrasp/planning/grasp_places.h"
#include "boxgrasp/planning/hypotheses.h"
#include "boxgrasp/planning/tally.h"

namespace boxgrasp {
namespace {

// How far the outline turns inwards where the fingers are, on average.
double concavity(const Grasp& grasp) {
  const auto& turn = grasp.triplet.turn_rad;
  return -(turn[0] + turn[1] + turn[2]) / 3.0;
}

void preferConcave(double weight, const std::vector<Grasp*>& grasps) {
  double sum = 0.0, squares = 0.0;
  for (const Grasp* grasp : grasps) {
    sum += grasp->score;
    squares += grasp->score * grasp->score;
  }
  const auto n = static_cast<double>(grasps.size());
  const double deviation = std::sqrt(std::max(0.0, squares / n - (sum / n) * (sum / n)));
  for (Grasp* grasp : grasps) grasp->score += weight * deviation * concavity(*grasp);
}

// The networks' scores, corrected by what became of such grasps on objects like this.
VectorXd recalled(const Model& model, const RecallOptions& options, const PlannedObject& object,
                  const std::vector<const Grasp*>& grasps, const VectorXd& scores) {
  const VectorXd corrected =
      scores + corrections(constellationOf(object.tree), graspPlaces(object.tree, grasps),
                           model.recollections, options);
  return model.ensemble.calibration ? VectorXd(corrected.cwiseMax(0.0).cwiseMin(1.0)) : corrected;
}

// All grasps of one object at once: places among them count.
void scoreObject(const Model& model, const PlannedObject& object, const std::vector<Grasp*>& grasps,
                 const PlannerOptions& options, double friction, const StopToken& stop) {
  const MeasuringOptions measuring{model.features, friction, options.threads};
  const std::vector<const Grasp*> measured(grasps.begin(), grasps.end());
  const MatrixXd measures = graspMeasures(object, measured, measuring, stop);
  const MatrixXd inputs = networkInputs(model.features, measures);
  VectorXd all = scores(model.ensemble, inputs);
  if (options.recall.enabled) all = recalled(model, options.recall, object, measured, all);
  for (Eigen::Index i = 0; i < all.size(); ++i) {
    Grasp& grasp = *grasps[static_cast<std::size_t>(i)];
    grasp.score = all[i];
    grasp.inputs.assign(inputs.row(i).begin(), inputs.row(i).end());
  }
  if (options.concavity_weight > 0) preferConcave(options.concavity_weight, grasps);
}

void rank(const Model& model, const PlannerOptions& options, double friction, const StopToken& stop,
          PlanResult& result, Tally& tally) {
  const StageTimer timer(tally, StageId::ranking);
  if (result.grasps.empty()) return;
  std::vector<std::vector<Grasp*>> by_object(result.objects.size());
  for (Grasp& grasp : result.grasps) by_object[static_cast<std::size_t>(grasp.object)].push_back(&grasp);
  for (std::size_t i = 0; i < by_object.size(); ++i) {
    if (!by_object[i].empty()) scoreObject(model, result.objects[i], by_object[i], options, friction, stop);
  }
  std::stable_sort(result.grasps.begin(), result.grasps.end(),
                   [](const Grasp& a, const Grasp& b) { return a.score > b.score; });
  tally.count(StageId::ranking, result.grasps.size(), result.grasps.size());
  if (options.recall.enabled && model.recollections.empty())
    result.report.notes.push_back(
        "recall.enabled is true, but the model remembers no objects; train it with --recollections");
}

void keepDistinct(const PlannerOptions& options, int top_k, const StopToken& stop, std::vector<Grasp>& grasps,
                  Tally& tally) {
  const StageTimer timer(tally, StageId::distinct);
  if (grasps.empty()) return;
  const std::size_t before = grasps.size();
  grasps = distinctGrasps(std::move(grasps), top_k, options.merge_distance_m, options.merge_angle_rad, stop);
  tally.count(StageId::distinct, before, grasps.size());
}

void describeAnswer(const RobotOptions& options, const PlanRequest& request, PlanResult& result) {
  const Robot robot(options, request.robot);
  result.X_TP = robot.X_TP();
  if (robot.answerFrame() == AnswerFrame::cloud) return;
  result.frame = options.frame;
  result.X_AC = robot.X_RC();
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
  shapes.validate();
  recall.validate();
  requireOption(concavity_weight >= 0 && concavity_weight <= 100, "concavity_weight", concavity_weight,
                "in [0, 100]");
  robot.validate();
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
  checkFeatures(model_.features);
}

PlanResult GraspPlanner::plan(PlanRequest request, const StopToken& stop, PlanTrace* trace) const {
  const auto start = std::chrono::steady_clock::now();
  PlanResult result;
  result.model_version = model_.version;
  result.report.seed = options_.scene.seed;
  Tally tally;
  try {
    stop.check();
    requireOption(request.top_k >= 0, "top_k", request.top_k, "at least 0");
    describeAnswer(options_.robot, request, result);
    const double friction = request.friction;
    const int top_k = request.top_k;
    findHypotheses(hand_, options_, std::move(request), stop, trace, result, tally);
    rank(model_, options_, friction, stop, result, tally);
    keepDistinct(options_, top_k, stop, result.grasps, tally);
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
