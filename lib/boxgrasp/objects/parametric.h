// Objects built by formula: closed, outward oriented meshes in metres.
#pragma once

#include <string>
#include <vector>

#include "boxgrasp/geometry/triangle_mesh.h"

namespace boxgrasp {

// The names of all parametric objects, in a fixed order: mug, cup, goblet, paper_cup, pen, pillow, radio, heart, car, ...
std::vector<std::string> parametricNames();

// The mesh of a named object at its natural size (that of the real thing, graspable by a hand of 0.25 m span) times `scale`.
// Throws InputError for an unknown name, listing the known ones, or scale <= 0.
TriangleMesh parametricObject(const std::string& name, double scale = 1.0);

}  // namespace boxgrasp
