#include "boxgrasp/decomposition/line_bounds.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include "boxgrasp/base/ordered_bits.h"
#include "boxgrasp/base/simd.h"

namespace boxgrasp {

namespace line_bound_passes {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The place of the point farthest along (u, v) among those with a * x + b * y <= limit; n if there is none.
// Pre: n is at most kMostBoundPoints.
BOXGRASP_SIMD std::int32_t farthest(const float* x, const float* y, std::int32_t n, float u, float v, float a,
                                    float b, float limit) {
  std::int32_t keys[kMostBoundPoints], best = std::numeric_limits<std::int32_t>::min();
  for (std::int32_t i = 0; i < n; ++i) {
    const float along = u * x[i] + v * y[i];
    keys[i] = orderedBits(a * x[i] + b * y[i] <= limit ? along : -kInfinity);
    best = keys[i] > best ? keys[i] : best;
  }
  std::int32_t place = n;
  for (std::int32_t i = 0; i < n; ++i) {
    const std::int32_t here = keys[i] == best ? i : n;
    place = here < place ? here : place;
  }
  return best == orderedBits(-kInfinity) ? n : place;
}

}  // namespace line_bound_passes

namespace {

constexpr double kNextToLine =
    1e-6;  // of the points' reach: nearer to a line, rounding may move a point across
constexpr double kBoundSlack = 1e-6;  // of the reach squared, for the rounding errors of areas and arcs

// The points with normal.p <= limit.
struct Side {
  float normal_x, normal_y, limit;

  bool has(const Vector2d& p) const {
    return normal_x * static_cast<float>(p.x()) + normal_y * static_cast<float>(p.y()) <= limit;
  }
};

// What is on the right of the way between two samples, further from it than a margin.
Side sideOf(const CutLines& cuts, std::size_t from, std::size_t to, float margin) {
  const Line& line = cuts.lines[from < to ? cuts.index(from, to) : cuts.index(to, from)].line;
  if (from < to) return {line.normal_x, line.normal_y, line.offset - margin};
  return {-line.normal_x, -line.normal_y, -line.offset - margin};
}

// Grows a hull beyond one of its edges as quickhull does, to a depth.
class Growth {
 public:
  // Points nearer to an edge than the margin do not count: which of them are outermost is chance.
  Growth(const std::vector<float>& x, const std::vector<float>& y, const Side& side, double margin)
      : x_(x), y_(y), side_(side), margin_(margin) {}

  // The area that is gained beyond the edge from a to b, which has the hull on its left.
  double beyond(const Vector2d& a, const Vector2d& b, int depth) const {
    const Vector2d along = b - a;
    const bool is_point = along.squaredNorm() == 0.0;
    const Vector2d outward =
        is_point ? Vector2d(side_.normal_x, side_.normal_y) : Vector2d(along.y(), -along.x());
    const auto n = static_cast<std::int32_t>(x_.size());
    const std::int32_t place = line_bound_passes::farthest(
        x_.data(), y_.data(), n, static_cast<float>(outward.x()), static_cast<float>(outward.y()),
        side_.normal_x, side_.normal_y, side_.limit);
    if (place == n) return 0.0;
    const Vector2d p(x_[static_cast<std::size_t>(place)], y_[static_cast<std::size_t>(place)]);
    const double gained = -0.5 * cross(along, p - a);
    if (is_point ? p == a : gained <= 0.5 * along.norm() * margin_) return 0.0;
    if (depth == 1) return gained;
    return gained + beyond(a, p, depth - 1) + beyond(p, b, depth - 1);
  }

 private:
  const std::vector<float>&x_, &y_;
  const Side& side_;
  double margin_;
};

}  // namespace

std::vector<LineBlock> blocksOf(const CutLines& cuts) {
  const std::size_t each = cuts.per_segment;
  std::vector<LineBlock> blocks;
  for (std::size_t from = 0; from < cuts.segments(); ++from) {
    for (std::size_t to = from + 1; to < cuts.segments(); ++to)
      blocks.push_back({from * each, (from + 1) * each - 1, to * each, (to + 1) * each - 1});
  }
  return blocks;
}

std::array<LineBlock, 2> halvesOf(const LineBlock& block) {
  std::array<LineBlock, 2> halves{block, block};
  if (block.last_from - block.first_from > block.last_to - block.first_to) {
    halves[0].last_from = (block.first_from + block.last_from) / 2;
    halves[1].first_from = halves[0].last_from + 1;
  } else {
    halves[0].last_to = (block.first_to + block.last_to) / 2;
    halves[1].first_to = halves[0].last_to + 1;
  }
  return halves;
}

ThetaBounds::ThetaBounds(const HullArcs& arcs, const CutLines& cuts, double face_area,
                         const std::vector<Vector2d>& points)
    : arcs_(arcs), cuts_(cuts), face_area_(face_area) {
  assert(points.size() <= kMostBoundPoints);
  for (const Vector2d& p : points) {
    x_.push_back(static_cast<float>(p.x()));
    y_.push_back(static_cast<float>(p.y()));
  }
  for (const Vector2d& p : arcs.hull()) reach_ = std::max(reach_, p.lpNorm<Eigen::Infinity>());
}

double ThetaBounds::of(const LineBlock& block, int depth) const {
  const double area =
      sideArea(block.last_from, block.first_to, depth) + sideArea(block.last_to, block.first_from, depth);
  return (area - kBoundSlack * reach_ * reach_) / face_area_;
}

double ThetaBounds::sideArea(std::size_t from, std::size_t to, int depth) const {
  const double margin = kNextToLine * reach_;
  const Side side = sideOf(cuts_, from, to, static_cast<float>(margin));
  Arc arc{arcs_.next(cuts_.samples[from].before), cuts_.samples[to].before};
  while (!side.has(arcs_.at(arc.first))) {
    if (arc.first == arc.last) return 0.0;
    arc.first = arcs_.next(arc.first);
  }
  while (!side.has(arcs_.at(arc.last))) arc.last = arcs_.previous(arc.last);
  return arcs_.area(arc) +
         Growth(x_, y_, side, margin).beyond(arcs_.at(arc.last), arcs_.at(arc.first), depth);
}

}  // namespace boxgrasp
