// The hull of the wrenches of three contacts, the grasps of a hand with three fingers, in closed form.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "boxgrasp/wrench/hull.h"

namespace boxgrasp {

// A contact's linearised friction cone.
struct ForceCone {
  Vector3d arm;     // from the centre of gravity to the contact, over the torque scale
  Vector3d normal;  // unit, inward
  std::vector<Vector3d>
      edges;  // in order around the normal, counter-clockwise; their component along it is 1
};

// The hull of all edges' wrenches (f, arm x f). Every edge polygon is planar, which leaves two kinds of
// facets: a side of each polygon, or a whole polygon with a side and a corner of the others; each is tried.
// nullopt where rounding decides: flat hulls, more than one facet in a plane, and some grasps without force
// closure. Pre: the cones have at least three edges, all of a cone of the same length.
std::optional<WrenchHull> threeConeHull(const std::array<ForceCone, 3>& cones);

}  // namespace boxgrasp
