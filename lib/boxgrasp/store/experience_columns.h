// The columns of an experience store's tables, in their order.
#pragma once

#include "boxgrasp/store/columns.h"
#include "boxgrasp/training/experience.h"

namespace boxgrasp {

void visitColumns(IsA<ModelRecord> auto& model, auto&& visit) {
  visit("object", model.key.object);
  visit("scale", model.key.scale);
  visit("view", model.key.view);
  visit("mesh_hash", model.mesh_hash);
  visit("mass_kg", model.mass_kg);
  visit("size_m", model.size_m);
  visit("boxes", model.boxes);
  visit("leaves", model.leaves);
  visit("projections", model.projections);
  visit("triplets", model.triplets);
  visit("configurations", model.configurations);
  visit("message", model.message);
}

void visitColumns(IsA<HypothesisRecord> auto& hypothesis, auto&& visit) {
  visit("source", hypothesis.source);
  visit("grasp_index", hypothesis.index);
  visit("X_OP", hypothesis.X_OP);
  visit("joints", hypothesis.joints);
  visit("pregrasp", hypothesis.pregrasp);
  visit("approach_m", hypothesis.approach_m);
  visitColumns(hypothesis.quality, visit);
  visit("box", hypothesis.box);
  visit("face", hypothesis.face);
}

void visitColumns(IsA<GraspLabel> auto& label, auto&& visit) {
  visit("perturbation", label.perturbation);
  visit("seed", label.seed);
  visit("friction", label.friction);
  visit("mass_factor", label.mass_factor);
  visit("outcome", label.outcome);
  visit("force_closure", label.force_closure);
  visit("epsilon", label.epsilon);
  visit("nu", label.nu);
  visit("lift_slip_m", label.lift_slip_m);
  visit("lift_rotation_rad", label.lift_rotation_rad);
  visit("push_force_n", label.push_force_n);
  visit("six_push_displacement_m", label.six_push_displacement_m);
  visit("gravities_held", label.gravities_held);
  visit("contacts", label.contacts);
}

}  // namespace boxgrasp
