#include "tried_object.h"

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <sstream>

#include "boxgrasp/base/parallel.h"
#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/planning/default_model.h"
#include "boxgrasp/planning/grasp_planner.h"
#include "boxgrasp/planning/hypotheses.h"
#include "boxgrasp/planning/planner_config.h"
#include "boxgrasp/training/analytic_labels.h"
#include "boxgrasp/training/baselines.h"
#include "boxgrasp/training/labelling.h"

namespace boxgrasp {
TriedObject triedObject(const ObjectSource& source, const StopToken& stop) {
  TriangleMesh mesh_O = loadObject(source, stop).mesh_O;
  SimulatedObject solid = makeSimulatedObject(mesh_O);
  return {source.name, source.scale, std::move(mesh_O), std::move(solid)};
}

ObjectSource sourceOf(const std::string& object, double scale) {
  ObjectSource source{object, scale, {}};
  if (!std::filesystem::exists(object)) return source;
  source.file = object;
  source.name = source.file.stem().string();
  return source;
}

std::optional<std::vector<ObjectSource>> parametricSet(const std::string& set,
                                                       const std::vector<double>& scales) {
  if (set == "builtin") return builtinObjects(scales);
  if (set == "paper") return paperObjects(scales);
  const std::vector<std::string> known = parametricNames();
  std::vector<ObjectSource> sources;
  std::istringstream names(set);
  for (std::string name; std::getline(names, name, ',');) {
    if (std::find(known.begin(), known.end(), name) == known.end()) return std::nullopt;
    for (const double scale : scales) sources.push_back({name, scale, {}});
  }
  if (sources.empty()) return std::nullopt;
  return sources;
}

std::vector<ObjectSource> sourcesOf(const std::string& set, const std::vector<double>& scales) {
  if (const auto parametric = parametricSet(set, scales)) return *parametric;
  return meshFolder(set, {.scales = scales});
}

Planning planningWith(const std::optional<std::filesystem::path>& hand,
                      const std::optional<std::filesystem::path>& config) {
  Planning planning;
  planning.hand = handOrBarrett(hand);
  if (config) {
    ConfigFile file(*config);
    planning.options = readPlannerOptions(file);
    file.skip("server");
    file.finish();
    planning.changed = file.changed();
  }
  planning.options.scene.whole = true;
  planning.model = modelOrDefault({}, planning.hand);
  return planning;
}

FoundGrasps findGrasps(const Planning& planning, const TriedObject& object, const std::string& view,
                       const SightOptions& sight, const StopToken& stop) {
  const PlanRequest request = sightOf(object.mesh_O, {object.name, object.scale, view}, sight, stop);
  PlanResult all;
  Tally tally;
  findHypotheses(planning.hand, planning.options, request, stop, nullptr, all, tally);
  const PlanResult best = GraspPlanner(planning.hand, planning.model, planning.options).plan(request, stop);
  stop.check();
  const double approach_m = planning.options.clearance.approach_m;
  FoundGrasps found{recordsOf(all.grasps, approach_m),
                    recordsOf(best.grasps, approach_m),
                    {},
                    best.message,
                    best.report.time_s};
  if (!all.objects.empty())
    found.approach = approachHypotheses(planning.hand, all.objects.front().tree, all.objects.front().cloud_C);
  return found;
}

TrialOptions trialOptions(GraspSource source, TrialStage last_stage) {
  TrialOptions options;
  options.last_stage = last_stage;
  options.back_up_on_touch = source != GraspSource::planner;
  return options;
}

std::vector<TrialResult> tryAll(const HandDescription& hand, const SimulatedObject& object,
                                const std::vector<HypothesisRecord>& grasps, const TrialOptions& options,
                                int threads, const StopToken& stop,
                                const std::function<void(std::size_t)>& progress) {
  std::vector<TrialResult> results(grasps.size());
  std::mutex reporting;
  std::size_t done = 0;
  parallelFor(grasps.size(), threads, [&](std::size_t i) {
    results[i] = runTrial(hand, object, trialInput(grasps[i]), options, stop);
    const std::lock_guard lock(reporting);
    progress(++done);
  });
  return results;
}

VectorXd successesOf(const std::vector<TrialResult>& results) {
  const auto n = static_cast<Eigen::Index>(results.size());
  VectorXd epsilon(n), nu(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    epsilon[i] = results[static_cast<std::size_t>(i)].quality.epsilon;
    nu[i] = std::max(0.0, results[static_cast<std::size_t>(i)].quality.volume);
  }
  return successes(epsilon, nu);
}

}  // namespace boxgrasp
