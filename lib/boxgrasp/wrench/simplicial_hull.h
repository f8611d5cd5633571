// The hull of a few dozen wrenches, several times faster than by qhull.
#pragma once

#include <optional>

#include "boxgrasp/wrench/hull.h"
#include "boxgrasp/wrench/positive_span.h"

namespace boxgrasp {

// Adds one point after the other to a simplex (beneath and beyond), in the order of the columns. All facets
// are simplices; a facet with more than six points becomes several in one plane. Before it answers, every
// plane is checked to pass through its vertices and to have no point beyond it, and the facets to close:
// nullopt where rounding broke that. Pre: the first seven points are affinely independent. Memory: facets
// times points, so for up to a hundred points or so.
std::optional<WrenchHull> simplicialHull(const WrenchMatrix& points);

}  // namespace boxgrasp
