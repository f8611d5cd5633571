// From a mesh to labelled grasps: what the planner, chance, and approach-and-close propose on it, and what
// the simulator says of each. Every model and every label depends on its own input, the options and the seed
// alone, so work may be split over threads, processes and machines in any way.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "boxgrasp/planning/plan.h"
#include "boxgrasp/ranking/network.h"
#include "boxgrasp/ranking/recollections.h"
#include "boxgrasp/simulation/object.h"
#include "boxgrasp/simulation/perturbation.h"
#include "boxgrasp/simulation/protocols.h"
#include "boxgrasp/training/experience.h"

namespace boxgrasp {

struct LabellingOptions {
  // Of the cloud of the whole surface. More cost planning time, and change boxes little.
  std::size_t points = 30'000;
  // Of each model and source, evenly chosen from all; they keep their index among all. 0: all of them.
  int limit = 0;
  int random = 200;  // random grasps on each model, where they are asked for
  // Earlier stages take a fraction of the time, and leave out the labels of the later ones.
  TrialStage last_stage = TrialStage::push;
  // The published protocols too, of each hypothesis as planned; they take several times as long as a trial.
  bool protocols = false;
  std::uint64_t seed = 1;  // of surface points, cameras, random grasps and perturbations
  PlannerOptions planner;  // its threads are set by whoever labels
  TrialOptions trial;      // its last_stage is the one above
  PerturbationOptions perturbation;
  void validate() const;
};

// All that labels depend on besides the model, one "name = value" a line, for ExperienceStore.
std::string labellingSettings(const HandDescription& hand, const LabellingOptions& options,
                              const std::string& code_version);

// The planner's grasps as hypotheses, numbered in their order. `approach_m`: length of the straight way in.
std::vector<HypothesisRecord> recordsOf(const std::vector<Grasp>& grasps, double approach_m);

// A model with the grasps to try on it.
struct PlannedModel {
  ModelRecord record;
  std::vector<HypothesisRecord> hypotheses;  // source by source, in the order asked for
};

// Plans on what `key.view` shows of the object with so many cameras around it (sights.h). No grasps are no
// error: record.message says why. Throws InputError for a mesh that cannot be planned on or simulated;
// Stopped.
PlannedModel planModel(const HandDescription& hand, const TriangleMesh& mesh_O, const ModelKey& key,
                       int cameras, const std::vector<GraspSource>& sources, const LabellingOptions& options,
                       const StopToken& stop = {});

// What a ranking asks of all the planner's hypotheses on a model; row and place i are of the one of index i.
struct HypothesisMeasures {
  MatrixXd values;  // as from graspMeasures()
  Constellation constellation;
  std::vector<GraspPlace> places;
};

// For networks with these features, planned as planModel() does with the same input. Throws as planModel();
// and InputError that names the first of `known` whose pose or quality measures are not as planned anew,
// because another version of the planner made it.
HypothesisMeasures hypothesisMeasures(const HandDescription& hand, const TriangleMesh& mesh_O,
                                      const ModelKey& key, int cameras,
                                      const std::vector<HypothesisRecord>& known,
                                      const std::vector<std::string>& features,
                                      const LabellingOptions& options, const StopToken& stop = {});

// What ModelRecord::mesh_hash is of this mesh.
std::string meshHash(const TriangleMesh& mesh);

// Tries a grasp as planned (0), or under its k-th perturbation. Grasps of other sources than the planner
// close where they touch (baselines.h).
GraspLabel labelGrasp(const HandDescription& hand, const SimulatedObject& solid, const ModelKey& key,
                      const HypothesisRecord& hypothesis, int perturbation, const LabellingOptions& options);

// s of each hypothesis as planned (Eq. 6), over the largest epsilon and nu among them: pass all hypotheses of
// one object, in all its sizes and views. 0 where the hand came to no grasp; NaN where that label is not
// there yet.
VectorXd successes(const std::vector<LabelledHypothesis>& labelled);

// The label as planned; null where it is not there yet.
const GraspLabel* labelAsPlanned(const LabelledHypothesis& labelled);

}  // namespace boxgrasp
