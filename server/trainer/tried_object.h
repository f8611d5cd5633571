// Objects to try grasps on, and the grasps to try.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "boxgrasp/objects/object_set.h"
#include "boxgrasp/ranking/network.h"
#include "boxgrasp/simulation/object.h"
#include "boxgrasp/training/experience.h"

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

// "builtin": all parametric objects; else the meshes in that folder, in metres.
std::vector<ObjectSource> sourcesOf(const std::string& set, double scale);

struct FoundGrasps {
  std::vector<HypothesisRecord> hypotheses;  // all of the planner's, in their fixed order
  std::vector<HypothesisRecord> answer;      // what a robot would get: distinct ones, the best first
  std::vector<HypothesisRecord> approach;    // approach-and-close (paper, ref. [11])
};

// Plans on points of the whole surface, with the defaults. No grasps are no error.
FoundGrasps findGrasps(const HandDescription& hand, const TriangleMesh& mesh_O, int threads,
                       const StopToken& stop);

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
