// Fewer triangles for the same shape.
#pragma once

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/triangle_mesh.h"

namespace boxgrasp {

// The mesh with vertices taken out until at most `triangles` are left, short edges first: a vertex moves
// along an edge into its neighbour where that keeps the surface a manifold and turns no triangle by more than
// about 75 degrees. All vertices that remain are vertices of the mesh that came; a closed manifold stays one
// of the same genus. Where no edge can be taken any more, more triangles remain. Pre: the mesh is a closed
// manifold.
TriangleMesh simplified(TriangleMesh mesh, std::size_t triangles, const StopToken& stop = {});

}  // namespace boxgrasp
