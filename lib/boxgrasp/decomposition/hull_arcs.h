// Runs of vertices of a convex polygon, and their areas.
#pragma once

#include <vector>

#include "boxgrasp/geometry/polygon.h"

namespace boxgrasp {

// The vertices from `first` to `last`, counter-clockwise; both belong to it.
struct Arc {
  std::size_t first = 0, last = 0;
};

class HullArcs {
 public:
  // Pre: counter-clockwise, with three vertices or more.
  explicit HullArcs(Polygon hull);

  const Polygon& hull() const { return hull_; }
  const Vector2d& at(std::size_t vertex) const { return hull_[vertex]; }
  std::size_t next(std::size_t vertex) const { return vertex + 1 < hull_.size() ? vertex + 1 : 0; }
  std::size_t previous(std::size_t vertex) const { return (vertex > 0 ? vertex : hull_.size()) - 1; }

  // The area of the polygon of an arc's vertices, in O(1).
  double area(const Arc& arc) const;

 private:
  Polygon hull_;
  std::vector<double> twice_;  // [k]: the sum over the first k edges of the cross product of their ends
};

}  // namespace boxgrasp
