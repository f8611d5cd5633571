// From an implicit function to a mesh.
#pragma once

#include "boxgrasp/geometry/triangle_mesh.h"
#include "boxgrasp/objects/field.h"

namespace boxgrasp {

// The surface where the field is zero within the bounds, by marching cubes of about `cell`: a closed
// 2-manifold, outward oriented, whose vertices lie on the surface. Details below one cell may be lost. Throws
// InputError when the field is not positive everywhere on the faces of the bounds (the surface would be
// open), or for more than 2^25 cells. Pre: bounds are not empty, cell > 0, the field is finite.
TriangleMesh polygonise(const Field& field, const Eigen::AlignedBox3d& bounds, double cell);

}  // namespace boxgrasp
