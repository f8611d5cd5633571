// Lower bounds of Theta (Eq. 1) for all cut lines of a face at once.
#pragma once

#include <functional>
#include <vector>

#include "boxgrasp/decomposition/cut_lines.h"

namespace boxgrasp {

// Raises the bounds of the lines for which `wanted` holds to Theta over the given few points of the face,
// which is at most that over all of them. Sorted by their angle around a sample, points can be added to a
// hull one by one, each a vertex when it comes; so one sweep to and fro gives the hulls on both sides of
// every line through the sample. O(s m log m) for s samples and m points. Points next to a line are left out
// of its bound, so that rounding never puts one on the wrong side.
void raiseThetaBounds(const FaceProjection& face, const std::vector<Vector2d>& few, const CutLines& cuts,
                      const std::function<bool(double)>& wanted, std::vector<double>& bounds);

// areas[k] is the area of the convex hull of the first k points. Pre: they lie in the half plane y >= 0 and
// are sorted by rising angle around the origin.
std::vector<double> areasOfGrowingHull(const std::vector<Vector2d>& sorted);

}  // namespace boxgrasp
