#include "boxgrasp/training/labelling.h"

#include <fmt/format.h>

#include <algorithm>

#include "boxgrasp/base/error.h"
#include "boxgrasp/objects/mesh_properties.h"
#include "boxgrasp/planning/features.h"
#include "boxgrasp/planning/grasp_places.h"
#include "boxgrasp/planning/hypotheses.h"
#include "boxgrasp/training/analytic_labels.h"
#include "boxgrasp/training/baselines.h"
#include "boxgrasp/training/sights.h"

namespace boxgrasp {
namespace {

struct Planned {
  PlanResult result;
  Tally tally;
  double friction = 0.0;
};

Planned plan(const HandDescription& hand, const TriangleMesh& mesh_O, const ModelKey& key, int cameras,
             const LabellingOptions& options, const StopToken& stop) {
  options.validate();
  PlannerOptions planner = options.planner;
  planner.scene.whole = true;
  PlanRequest request = sightOf(mesh_O, key, {options.points, cameras, options.seed}, stop);
  Planned planned{.result = {}, .tally = {}, .friction = request.friction};
  findHypotheses(hand, planner, std::move(request), stop, nullptr, planned.result, planned.tally);
  stop.check();
  return planned;
}

void requireAsPlanned(const ModelKey& key, const std::vector<HypothesisRecord>& known,
                      const std::vector<Grasp>& grasps) {
  for (const HypothesisRecord& record : known) {
    const auto index = static_cast<std::size_t>(record.index);
    if (index < grasps.size() && grasps[index].quality == record.quality &&
        grasps[index].X_CP.matrix() == record.X_OP.matrix())
      continue;
    throw InputError(fmt::format(
        "hypothesis {} on {} at scale {} is not what the planner finds there now: another version "
        "of it made the labels; label again, into a new store",
        record.index, key.object, key.scale));
  }
}

void count(const PlanResult& result, const Tally& tally, ModelRecord& record) {
  record.boxes = static_cast<std::int64_t>(tally[StageId::decomposition].out);
  record.projections = static_cast<std::int64_t>(tally[StageId::faces].out);
  record.triplets = static_cast<std::int64_t>(tally[StageId::triplets].out);
  record.configurations = static_cast<std::int64_t>(tally[StageId::configurations].out);
  if (result.grasps.empty()) record.message = whyNoGrasp(tally);
  if (result.objects.empty()) return;
  record.leaves = static_cast<std::int64_t>(result.objects.front().tree.leaves().size());
  record.size_m = objectSize(result.objects.front());
}

HypothesisRecord recordOf(const Grasp& grasp, std::size_t index, double approach_m) {
  HypothesisRecord record;
  record.index = static_cast<int>(index);
  record.X_OP = grasp.X_CP;
  record.joints = grasp.joints;
  record.pregrasp = grasp.pregrasp;
  record.approach_m = approach_m;
  record.quality = grasp.quality;
  record.box = grasp.box;
  record.face = grasp.face;
  return record;
}

std::vector<HypothesisRecord> hypothesesOf(GraspSource source, const HandDescription& hand,
                                           const TriangleMesh& mesh_O, const ModelKey& key,
                                           const PlanResult& result, const LabellingOptions& options) {
  std::vector<HypothesisRecord> records;
  switch (source) {
    case GraspSource::planner:
      records = recordsOf(result.grasps, options.planner.clearance.approach_m);
      break;
    case GraspSource::random:
      records = randomHypotheses(hand, mesh_O, options.random, derivedSeed(options.seed, key, "random", 0));
      break;
    case GraspSource::approach:
      if (!result.objects.empty()) {
        const PlannedObject& object = result.objects.front();
        records = approachHypotheses(hand, object.tree, object.cloud_C);
      }
      break;
  }
  return records;
}

// The middle one of each of `limit` equal shares.
void thin(std::vector<HypothesisRecord>& records, int limit) {
  const auto all = records.size(), few = static_cast<std::size_t>(limit);
  if (limit == 0 || all <= few) return;
  for (std::size_t i = 0; i < few; ++i) records[i] = records[(2 * i + 1) * all / (2 * few)];
  records.resize(few);
}

GraspLabel labelOf(const TrialResult& result) {
  GraspLabel label;
  label.outcome = result.outcome;
  label.force_closure = result.quality.force_closure;
  label.epsilon = result.quality.epsilon;
  label.nu = result.quality.volume;
  label.lift_slip_m = result.lift_slip_m;
  label.lift_rotation_rad = result.lift_rotation_rad;
  label.push_force_n = result.push_force_n;
  label.contacts = result.contacts;
  return label;
}

void addProtocols(const HandDescription& hand, const SimulatedObject& solid, const PerturbedTrial& trial,
                  GraspLabel& label) {
  label.six_push_displacement_m = pushSixWays(hand, solid, trial.input, trial.options).displacement_m;
  label.gravities_held = holdInSixGravities(hand, solid, trial.input, trial.options).directions_held;
}

// Not a number, where nothing was grasped, counts as nothing.
double atLeastZero(double x) { return x > 0 ? x : 0.0; }

}  // namespace

std::vector<HypothesisRecord> recordsOf(const std::vector<Grasp>& grasps, double approach_m) {
  std::vector<HypothesisRecord> records;
  for (std::size_t i = 0; i < grasps.size(); ++i) records.push_back(recordOf(grasps[i], i, approach_m));
  return records;
}

void LabellingOptions::validate() const {
  requireOption(points >= 1000, "points", points, "at least 1000");
  requireOption(limit >= 0, "limit", limit, "at least 0");
  requireOption(random >= 0, "random", random, "at least 0");
  planner.validate();
  trial.validate();
  perturbation.validate();
}

std::string labellingSettings(const HandDescription& hand, const LabellingOptions& options,
                              const std::string& code_version) {
  const PhysicsOptions& physics = options.trial.physics;
  return fmt::format(
      "code = {}\nhand = {}\nseed = {}\npoints = {}\nlimit = {}\nrandom = {}\nlast_stage = {}\nprotocols = "
      "{}\n"
      "force_closure = {}\nstep_s = {}\nfriction = {}\nshift_m = {}\nturn_rad = {}\nfriction_share = {}\n"
      "mass_share = {}\n",
      code_version, hand.name, options.seed, options.points, options.limit, options.random,
      static_cast<int>(options.last_stage), options.protocols,
      static_cast<int>(options.planner.force_closure), physics.step_s, physics.friction,
      options.perturbation.shift_m, options.perturbation.turn_rad, options.perturbation.friction_share,
      options.perturbation.mass_share);
}

std::string meshHash(const TriangleMesh& mesh) {
  std::string bytes;
  for (const Vector3d& vertex : mesh.vertices) {
    bytes.append(reinterpret_cast<const char*>(vertex.data()), sizeof(Vector3d));
  }
  for (const auto& triangle : mesh.triangles) {
    bytes.append(reinterpret_cast<const char*>(triangle.data()), sizeof triangle);
  }
  return blake2bHex(bytes);
}

PlannedModel planModel(const HandDescription& hand, const TriangleMesh& mesh_O, const ModelKey& key,
                       int cameras, const std::vector<GraspSource>& sources, const LabellingOptions& options,
                       const StopToken& stop) {
  const auto [result, tally, friction] = plan(hand, mesh_O, key, cameras, options, stop);
  PlannedModel model;
  model.record.key = key;
  model.record.mesh_hash = meshHash(mesh_O);
  model.record.mass_kg = ObjectOptions{}.density_kg_m3 * massPropertiesOf(mesh_O).volume;
  count(result, tally, model.record);
  for (const GraspSource source : sources) {
    auto records = hypothesesOf(source, hand, mesh_O, key, result, options);
    thin(records, options.limit);
    for (HypothesisRecord& record : records) {
      record.source = source;
      model.hypotheses.push_back(std::move(record));
    }
  }
  return model;
}

HypothesisMeasures hypothesisMeasures(const HandDescription& hand, const TriangleMesh& mesh_O,
                                      const ModelKey& key, int cameras,
                                      const std::vector<HypothesisRecord>& known,
                                      const std::vector<std::string>& features,
                                      const LabellingOptions& options, const StopToken& stop) {
  const auto [result, tally, friction] = plan(hand, mesh_O, key, cameras, options, stop);
  requireAsPlanned(key, known, result.grasps);
  if (result.objects.empty()) return {};
  std::vector<const Grasp*> grasps;
  for (const Grasp& grasp : result.grasps) grasps.push_back(&grasp);
  const PlannedObject& object = result.objects.front();
  return {graspMeasures(object, grasps, {features, friction, options.planner.threads}, stop),
          constellationOf(object.tree), graspPlaces(object.tree, grasps)};
}

GraspLabel labelGrasp(const HandDescription& hand, const SimulatedObject& solid, const ModelKey& key,
                      const HypothesisRecord& hypothesis, int perturbation, const LabellingOptions& options) {
  TrialOptions trial = options.trial;
  trial.last_stage = options.last_stage;
  trial.back_up_on_touch = hypothesis.source != GraspSource::planner;
  const std::uint64_t seed = derivedSeed(options.seed, key, describe(hypothesis.source), hypothesis.index);
  const PerturbedTrial perturbed_trial =
      perturbed(trialInput(hypothesis), trial, options.perturbation, seed, perturbation);
  GraspLabel label = labelOf(runTrial(hand, solid, perturbed_trial.input, perturbed_trial.options));
  label.perturbation = perturbation;
  label.seed = seed;
  label.friction = perturbed_trial.options.physics.friction;
  label.mass_factor = perturbed_trial.options.physics.mass_factor;
  if (options.protocols && perturbation == 0) addProtocols(hand, solid, perturbed_trial, label);
  return label;
}

const GraspLabel* labelAsPlanned(const LabelledHypothesis& labelled) {
  const auto found = std::ranges::find(labelled.labels, 0, &GraspLabel::perturbation);
  return found == labelled.labels.end() ? nullptr : &*found;
}

VectorXd successes(const std::vector<LabelledHypothesis>& labelled) {
  const auto n = static_cast<Eigen::Index>(labelled.size());
  VectorXd epsilon = VectorXd::Zero(n), nu = VectorXd::Zero(n), unlabelled = VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const GraspLabel* label = labelAsPlanned(labelled[static_cast<std::size_t>(i)]);
    epsilon[i] = label ? atLeastZero(label->epsilon) : 0.0;
    nu[i] = label ? atLeastZero(label->nu) : 0.0;
    if (!label) unlabelled[i] = NAN;
  }
  return successes(epsilon, nu) + unlabelled;
}

}  // namespace boxgrasp
