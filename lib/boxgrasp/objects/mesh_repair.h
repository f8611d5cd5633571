// Mends what mesh files commonly have wrong without changing the shape.
#pragma once

#include <string>
#include <vector>

#include "boxgrasp/geometry/triangle_mesh.h"

namespace boxgrasp {

struct RepairedMesh {
  TriangleMesh mesh;
  std::vector<std::string> repairs;  // what was done, with counts; empty: nothing
};

// Drops triangles that are there twice or have a corner twice and vertices that no triangle uses, merges
// vertices at one place (nearer than a millionth of the mesh's extent) where the mesh is open without it, as
// STL files are - parts of a closed mesh may touch -, and turns triangles so that neighbours agree and closed
// parts face outward. Holes stay: topologyOf() finds them. Pre: the triangles
// index existing vertices, and these are finite.
RepairedMesh repaired(const TriangleMesh& mesh);

}  // namespace boxgrasp
