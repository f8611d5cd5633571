#include "boxgrasp/simulation/object.h"

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

constexpr double kMinExtent = 0.001, kMaxExtent = 2.0;  // metres: what a hand may meet

void requireFinite(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!mesh.vertices[i].allFinite()) {
      throw InputError(fmt::format("mesh: vertex {} is not finite; remove it or repair the file", i));
    }
  }
}

std::string flawOf(const MeshTopology& topology) {
  if (!topology.closed) return "it has open edges: fill its holes";
  if (!topology.manifold) return "more than two triangles meet in an edge, or parts touch in a vertex";
  if (!topology.oriented) return "neighbouring triangles face opposite ways: orient them alike";
  return "a part of it is inside out or encloses nothing: flip its triangles";
}

void requireSolid(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw InputError("mesh: no triangles, so there is nothing to simulate");
  requireFinite(mesh);
  const MeshTopology topology = topologyOf(mesh);
  if (!topology.boundsSolid()) throw InputError("mesh: does not bound a solid: " + flawOf(topology));
}

void requireSize(const Eigen::AlignedBox3d& bounds) {
  const double extent = bounds.sizes().maxCoeff();
  if (extent >= kMinExtent && extent <= kMaxExtent) return;
  throw InputError(fmt::format("mesh: {} m across, but must be {} to {}: scale it to metres", extent,
                               kMinExtent, kMaxExtent));
}

}  // namespace

void ObjectOptions::validate() const {
  requireOption(density_kg_m3 > 0, "density_kg_m3", density_kg_m3, "positive");
  field.validate();
}

SimulatedObject makeSimulatedObject(const TriangleMesh& mesh, const ObjectOptions& options) {
  options.validate();
  requireSolid(mesh);
  Eigen::AlignedBox3d bounds;
  for (const Vector3d& p : mesh.vertices) bounds.extend(p);
  requireSize(bounds);
  const MassProperties mass = massPropertiesOf(mesh);
  return {options.density_kg_m3 * mass.volume,
          options.density_kg_m3,
          mass.center_M,
          options.density_kg_m3 * mass.inertia_M,
          largestDistance(mesh, mass.center_M),
          DistanceField(mesh, options.field)};
}

}  // namespace boxgrasp
