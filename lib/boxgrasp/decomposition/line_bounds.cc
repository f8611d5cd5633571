#include "boxgrasp/decomposition/line_bounds.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace boxgrasp {
namespace {

constexpr double kNextToLine =
    1e-6;  // of the points' reach: nearer to a line, rounding may move a point across
constexpr double kBoundSlack = 1e-6;  // of the reach squared, for the rounding errors of areas and arcs

bool has(const HalfPlane& side, const Vector2d& p) {
  return side.normal_x * static_cast<float>(p.x()) + side.normal_y * static_cast<float>(p.y()) <= side.offset;
}

// What is on the right of the way between two samples, further from it than a margin.
HalfPlane sideOf(const CutLines& cuts, std::size_t from, std::size_t to, float margin) {
  const Line& line = cuts.lines[from < to ? cuts.index(from, to) : cuts.index(to, from)].line;
  if (from < to) return {line.normal_x, line.normal_y, line.offset - margin};
  return {-line.normal_x, -line.normal_y, -line.offset - margin};
}

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
    : arcs_(arcs), cuts_(cuts), face_area_(face_area), points_(points) {
  assert(points.size() <= kMostBoundPoints);
  for (const Vector2d& p : arcs.hull()) reach_ = std::max(reach_, p.lpNorm<Eigen::Infinity>());
}

double ThetaBounds::of(const LineBlock& block, int depth) const {
  const double area =
      sideArea(block.last_from, block.first_to, depth) + sideArea(block.last_to, block.first_from, depth);
  return (area - kBoundSlack * reach_ * reach_) / face_area_;
}

double ThetaBounds::sideArea(std::size_t from, std::size_t to, int depth) const {
  const double margin = kNextToLine * reach_;
  const HalfPlane side = sideOf(cuts_, from, to, static_cast<float>(margin));
  Arc arc{arcs_.next(cuts_.samples[from].before), cuts_.samples[to].before};
  while (!has(side, arcs_.at(arc.first))) {
    if (arc.first == arc.last) return 0.0;
    arc.first = arcs_.next(arc.first);
  }
  while (!has(side, arcs_.at(arc.last))) arc.last = arcs_.previous(arc.last);
  return arcs_.area(arc) +
         PoolGrowth(points_, side, margin)
             .beyond({arcs_.at(arc.last), arcs_.at(arc.first)}, depth, [](const Vector2d&) {});
}

}  // namespace boxgrasp
