// Objects built by formula: closed, outward oriented meshes in metres.
#pragma once

#include <string>
#include <vector>

#include "boxgrasp/geometry/triangle_mesh.h"

namespace boxgrasp {

// The names of all parametric objects, in a fixed order: mug, cup, goblet, paper_cup, ...
std::vector<std::string> parametricNames();

// The mesh of a named object at its natural size (that of the real thing or of a toy of it, graspable by a
// hand of 0.25 m span) times `scale`. One closed 2-manifold, so that no point of the surface is inside the
// object; z is up, and the object stands or lies on the plane z = 0. Below 100,000 triangles. Takes up to
// half a second and is the same to the bit each time. Throws InputError for an unknown name, listing the
// known ones, or scale <= 0.
TriangleMesh parametricObject(const std::string& name, double scale = 1.0);

}  // namespace boxgrasp
