// What can be said of a mesh: whether it bounds a solid, and that solid's mass properties.
#pragma once

#include "boxgrasp/geometry/triangle_mesh.h"

namespace boxgrasp {

struct MeshTopology {
  bool closed = false;    // every edge of a triangle is met by another triangle
  bool manifold = false;  // at most two triangles meet in an edge, and those around a vertex form one fan
  bool oriented = false;  // no two triangles run along an edge in the same direction
  bool outward = false;   // closed, oriented, and the enclosed volume of every component is positive
  std::size_t components = 0;
  std::size_t open_edges = 0;     // edges of a single triangle
  std::size_t crowded_edges = 0;  // edges of more than two
  int euler_characteristic =
      0;  // vertices - edges + triangles: 2 - 2 genus for one closed component. Unused vertices do not count

  bool boundsSolid() const { return closed && manifold && outward; }
};
// A mesh without triangles is nothing of all that. Throws InputError for a triangle that names a vertex that
// does not exist, or one vertex twice.
MeshTopology topologyOf(const TriangleMesh& mesh);

// Of the solid inside, of density 1 kg/m^3, in the mesh's frame M: exact integrals over the polyhedron.
struct MassProperties {
  double volume = -1.0;                   // m^3
  Vector3d center_M = Vector3d::Zero();   // centre of mass
  Matrix3d inertia_M = Matrix3d::Zero();  // about the centre, axes of M, kg m^2
};
// Pre: the mesh is closed and outward oriented.
MassProperties massPropertiesOf(const TriangleMesh& mesh);

double surfaceArea(const TriangleMesh& mesh);  // m^2

// From p_M to the farthest vertex that a triangle uses; 0 for a mesh without triangles.
double largestDistance(const TriangleMesh& mesh, const Vector3d& p_M);

}  // namespace boxgrasp
