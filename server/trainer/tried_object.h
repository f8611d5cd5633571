// Objects to try grasps on, and the grasps to try.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "boxgrasp/objects/object_set.h"
#include "boxgrasp/ranking/network.h"
#include "boxgrasp/simulation/object.h"
#include "boxgrasp/training/experience.h"
#include "boxgrasp/training/sights.h"

namespace boxgrasp {

struct TriedObject {
  std::string name;
  double scale = 1.0;
  TriangleMesh mesh_O;
  SimulatedObject solid;
};

// Throws InputError for an object that cannot be simulated.
TriedObject triedObject(const ObjectSource& source, const StopToken& stop);

// `object` is a mesh file in metres, or else the name of a parametric object.
ObjectSource sourceOf(const std::string& object, double scale);

// The sets that need no files, each object in every scale: "builtin", all parametric objects; "paper", its
// Table I; or names of parametric objects, separated by commas. None for anything else.
std::optional<std::vector<ObjectSource>> parametricSet(const std::string& set,
                                                       const std::vector<double>& scales);

// A parametric set, or else the meshes in that folder, in metres.
std::vector<ObjectSource> sourcesOf(const std::string& set, const std::vector<double>& scales);

// How grasps are planned: hand, options and the model that ranks.
struct Planning {
  HandDescription hand = barrettHand();
  PlannerOptions options;
  std::vector<std::string> changed;  // which of them a file gave other values than the defaults
  Model model;
};

// The built-in hand and options, unless files are given; the built-in model. Throws InputError for bad files.
Planning planningWith(const std::optional<std::filesystem::path>& hand = {},
                      const std::optional<std::filesystem::path>& config = {});

struct FoundGrasps {
  std::vector<HypothesisRecord> hypotheses;  // all of the planner's, in their fixed order
  std::vector<HypothesisRecord> answer;      // what a robot would get: distinct ones, the best first
  std::vector<HypothesisRecord> approach;    // approach-and-close (paper, ref. [11])
  std::string message;                       // of the plan
  double time_s = 0.0;                       // ... and how long it took
};

// Plans on what `view` shows of the object (training/sights.h), as one object. No grasps are no error.
FoundGrasps findGrasps(const Planning& planning, const TriedObject& object, const std::string& view,
                       const SightOptions& sight, const StopToken& stop);

// The options with which grasps of this source are tried: all but the planner's close where they touch
// (baselines.h).
TrialOptions trialOptions(GraspSource source, TrialStage last_stage);

// One result each. `progress(done)` is called by one thread at a time.
std::vector<TrialResult> tryAll(const HandDescription& hand, const SimulatedObject& object,
                                const std::vector<HypothesisRecord>& grasps, const TrialOptions& options,
                                int threads, const StopToken& stop,
                                const std::function<void(std::size_t)>& progress);

// s of each (Eq. 6), from the contacts that the simulator found; 0 where it came to none.
VectorXd successesOf(const std::vector<TrialResult>& results);

}  // namespace boxgrasp
