// What the trainer knows of grasps: plain data, as the labeller makes it, the store keeps it, and learning
// reads it. Everything here depends on input, options and seed alone: no times, no paths.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "boxgrasp/hand/kinematics.h"
#include "boxgrasp/quality/measures.h"
#include "boxgrasp/simulation/trial.h"

namespace boxgrasp {

// One object in one size, seen in one way: the unit of labelling, and of sharding.
struct ModelKey {
  std::string object;          // its name; all sizes and views of an object share it
  double scale = 1.0;          // relative to the object's natural size
  std::string view = "whole";  // "whole": a cloud of the whole surface; else the name of a camera's view
  auto operator<=>(const ModelKey&) const = default;
};

// The model and what the planner found on it.
struct ModelRecord {
  ModelKey key;
  std::string mesh_hash;  // BLAKE2b of vertices and triangles
  double mass_kg = NAN;
  double size_m = NAN;  // L of the features
  std::int64_t boxes = 0, leaves = 0, projections = 0, triplets = 0, configurations = 0;
  std::string message;  // of the plan, e.g. why it found nothing
};

enum class GraspSource {
  planner,   // the planner's hypotheses
  random,    // the palm anywhere around the object, turned towards it: what chance reaches
  approach,  // approach-and-close along the normals of box faces (paper, ref. [11])
};
std::string_view describe(GraspSource source);

// A grasp that can be tried out, in the object's frame O (that of its mesh).
struct HypothesisRecord {
  GraspSource source = GraspSource::planner;
  int index = -1;  // among those of its model and source, in their fixed order
  Pose X_OP = Pose::Identity();
  HandJoints joints;          // closed on the object; planner alone
  HandJoints pregrasp;        // opened for the approach
  double approach_m = NAN;    // length of the straight way in
  QualityMeasures quality{};  // q1 .. q9; NaN where not planned
  int box = -1, face = -1;    // as in Grasp
};

// What the simulator said. What was not asked for, or not reached, is NaN or -1.
struct GraspLabel {
  int perturbation = 0;    // 0: as planned; k > 0: the k-th perturbation of pose, friction and mass
  std::uint64_t seed = 0;  // of the perturbation
  double friction = NAN;
  double mass_factor = 1.0;
  TrialOutcome outcome = TrialOutcome::missed;
  bool force_closure = false;
  double epsilon = NAN, nu = NAN;
  double lift_slip_m = NAN, lift_rotation_rad = NAN;
  double push_force_n = NAN;  // held along the weakest of the six directions of P's axes
  double six_push_displacement_m =
      NAN;                  // under six weak pushes (definitions 8, D(R,O)): at most 0.02 is success
  int gravities_held = -1;  // of six directions of gravity (definitions 8, DexGraspNet)
  std::vector<TrialContact> contacts;  // of the closed hand
};

// A hypothesis with all its labels: [0] as planned, then its perturbations in order.
struct LabelledHypothesis {
  HypothesisRecord hypothesis;
  std::vector<GraspLabel> labels;
};

}  // namespace boxgrasp
