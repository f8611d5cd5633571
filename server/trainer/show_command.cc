#include "show_command.h"

#include <fmt/format.h>

#include <algorithm>

#include "boxgrasp/base/error.h"
#include "boxgrasp/rendering/canvas.h"
#include "boxgrasp/simulation/perturbation.h"
#include "boxgrasp/store/experience_store.h"
#include "boxgrasp/training/baselines.h"
#include "interruption.h"
#include "spread_command.h"
#include "trial_film.h"
#include "tried_object.h"

namespace boxgrasp {
namespace {

// What is tried, and what came of it before.
struct Tried {
  HypothesisRecord hypothesis;
  std::optional<GraspLabel> label;
};

ObjectSource sourceIn(const std::string& set, const ModelKey& key) {
  const std::vector<ObjectSource> sources = sourcesOf(set, {key.scale});
  const auto found = std::find_if(sources.begin(), sources.end(),
                                  [&](const ObjectSource& source) { return source.name == key.object; });
  if (found != sources.end()) return *found;
  throw InputError(
      fmt::format("no object '{}' in '{}': name the folder of its mesh with --objects", key.object, set));
}

Tried fromStore(const ShowCommand& command, const GraspId& id) {
  const ExperienceStore store = ExperienceStore::openForReading(*command.store);
  for (const LabelledHypothesis& labelled : store.labelled(id.model, id.source)) {
    if (labelled.hypothesis.index != id.index) continue;
    for (const GraspLabel& label : labelled.labels) {
      if (label.perturbation == command.perturbation) return {labelled.hypothesis, label};
    }
  }
  throw InputError(fmt::format("'{}' holds no label {} of {}", command.store->string(), command.perturbation,
                               command.grasp));
}

std::vector<HypothesisRecord> graspsOf(const TriedObject& object, const GraspId& id, const StopToken& stop) {
  const Planning planning = planningWith();
  if (id.source == GraspSource::random)
    return randomHypotheses(planning.hand, object.mesh_O, id.index + 1, SpreadCommand{}.seed);
  FoundGrasps found = findGrasps(planning, object, wholeName(), {}, stop);
  return id.source == GraspSource::planner ? found.hypotheses : found.approach;
}

Tried fromPlan(const ShowCommand& command, const GraspId& id, const TriedObject& object,
               const StopToken& stop) {
  if (command.perturbation != 0) throw InputError("--perturbation needs a --store, which knows its seed");
  if (id.model.view != "whole")
    throw InputError("only grasps of view 'whole' can be shown without a --store");
  const std::vector<HypothesisRecord> grasps = graspsOf(object, id, stop);
  if (id.index < static_cast<int>(grasps.size())) return {grasps[static_cast<std::size_t>(id.index)], {}};
  throw InputError(fmt::format("there is no grasp {}: {} has {} grasps of this source", command.grasp,
                               formatModelKey(id.model), grasps.size()));
}

PerturbedTrial trialOf(const Tried& tried) {
  const TrialInput input = trialInput(tried.hypothesis);
  const TrialOptions options = trialOptions(tried.hypothesis.source, TrialStage::push);
  if (!tried.label) return {input, options};
  return perturbed(input, options, {}, tried.label->seed, tried.label->perturbation);
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

// What the label says otherwise; empty where it is the same.
std::string difference(const GraspLabel& label, const TrialResult& result) {
  if (label.outcome != result.outcome)
    return fmt::format("outcome '{}' there, '{}' here", describe(label.outcome), describe(result.outcome));
  const std::array<std::tuple<const char*, double, double>, 5> numbers{
      {{"epsilon", label.epsilon, result.quality.epsilon},
       {"nu", label.nu, result.quality.volume},
       {"slip in the lift", label.lift_slip_m, result.lift_slip_m},
       {"rotation in the lift", label.lift_rotation_rad, result.lift_rotation_rad},
       {"push force", label.push_force_n, result.push_force_n}}};
  for (const auto& [name, there, here] : numbers) {
    // A label may stop at an earlier stage than the film.
    if (!std::isnan(there) && !same(there, here))
      return fmt::format("{} {:.6g} there, {:.6g} here", name, there, here);
  }
  return {};
}

std::string verdict(const Tried& tried, const TrialResult& result) {
  if (!tried.label) return "planned anew";
  const std::string other = difference(*tried.label, result);
  return other.empty() ? "as the store's label says"
                       : fmt::format("NOT as the store's label says: {}", other);
}

}  // namespace

void runShow(const ShowCommand& command) {
  const GraspId id = parseGraspId(command.grasp);
  const StopToken stop = stopOnInterrupt();
  const TriedObject object = triedObject(sourceIn(command.objects, id.model), stop);
  const Tried tried = command.store ? fromStore(command, id) : fromPlan(command, id, object, stop);
  const PerturbedTrial trial = trialOf(tried);
  TrialRecorder recorder;
  const TrialResult result =
      runTrial(barrettHand(), object.solid, trial.input, trial.options, stop, recorder.observer());
  Film film = recorder.film(object.mesh_O, object.solid.center_O, trial.input);
  film.title = fmt::format("{}: {}", formatGraspId(id), result.report);
  film.subtitle = fmt::format("epsilon {:.4f}, nu {:.4f}, {}", result.quality.epsilon, result.quality.volume,
                              verdict(tried, result));
  writePng(drawFilm(film, barrettHand()), command.out);
  fmt::print("{}\n{}\nfilm written to {}\n", film.title, film.subtitle, command.out.string());
}

}  // namespace boxgrasp
