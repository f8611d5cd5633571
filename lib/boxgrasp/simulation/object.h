// Objects that can be simulated.
#pragma once

#include "boxgrasp/objects/mesh_properties.h"
#include "boxgrasp/simulation/distance_field.h"

namespace boxgrasp {

struct ObjectOptions {
  // Of the solid inside the mesh: that of light wood or of a filled plastic toy, and of the published
  // protocols (definitions, 8).
  double density_kg_m3 = 500.0;
  DistanceFieldOptions field;
  void validate() const;
};

// A rigid solid in its frame O, that of its mesh. Immutable once made: all threads may share one.
struct SimulatedObject {
  double mass_kg = NAN;
  double density_kg_m3 = NAN;
  Vector3d center_O = Vector3d::Zero();   // centre of mass
  Matrix3d inertia_O = Matrix3d::Zero();  // about the centre of mass, axes of O, kg m^2
  double largest_distance_m = NAN;        // from the centre of mass to the surface: the scale of torques
  DistanceField field;
};

// Throws InputError for a mesh that does not bound a solid, saying what is wrong with it, or one so large or
// small (extent beyond 1 mm to 2 m) that its unit cannot be the metre; and for bad options.
SimulatedObject makeSimulatedObject(const TriangleMesh& mesh, const ObjectOptions& options = {});

}  // namespace boxgrasp
