#include "boxgrasp/decomposition/hull_arcs.h"

#include <cassert>
#include <utility>

namespace boxgrasp {

HullArcs::HullArcs(Polygon hull) : hull_(std::move(hull)), twice_(hull_.size() + 1, 0.0) {
  assert(hull_.size() >= 3);
  for (std::size_t i = 0; i < hull_.size(); ++i) twice_[i + 1] = twice_[i] + cross(hull_[i], hull_[next(i)]);
}

double HullArcs::area(const Arc& arc) const {
  const double around = arc.first <= arc.last ? 0.0 : twice_.back();
  return 0.5 * (around + twice_[arc.last] - twice_[arc.first] + cross(hull_[arc.last], hull_[arc.first]));
}

}  // namespace boxgrasp
