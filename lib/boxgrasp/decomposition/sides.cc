#include "boxgrasp/decomposition/sides.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace boxgrasp {
namespace {

bool isFirst(const Line& line, const Vector2d& p) {
  return line.isFirst(static_cast<float>(p.x()), static_cast<float>(p.y()));
}

// The vertices of the hull of a vertex and points that are all further in a direction, from the vertex on and
// without it.
Polygon hullFrom(const Vector2d& vertex, const Vector2d& direction, std::vector<Vector2d> points) {
  const Vector2d farthest =
      *std::ranges::max_element(points, {}, [&](const Vector2d& p) { return direction.dot(p); });
  Polygon hull = hullBeyond(vertex, farthest, points);
  hull.push_back(farthest);
  const Polygon back = hullBeyond(farthest, vertex, std::move(points));
  hull.insert(hull.end(), back.begin(), back.end());
  return hull;
}

// The run of the hull's vertices on the first side of a line, if they are one and not all.
std::optional<Arc> firstArc(const HullArcs& arcs, const Line& line) {
  std::optional<std::size_t> begin, end;
  const std::size_t n = arcs.hull().size();
  bool before = isFirst(line, arcs.at(n - 1));
  for (std::size_t i = 0; i < n; ++i) {
    const bool first = isFirst(line, arcs.at(i));
    std::optional<std::size_t>& change = first ? begin : end;
    if (first != before && change) return std::nullopt;
    if (first != before) change = i;
    before = first;
  }
  if (!begin) return std::nullopt;
  return Arc{*begin, arcs.previous(*end)};
}

}  // namespace

HalfHull::HalfHull(const HullArcs& arcs, const Arc& arc, const Line& line, bool is_first)
    : line_(line),
      is_first_(is_first),
      arc_area_(arcs.area(arc)),
      chord_{arcs.at(arc.last), arcs.at(arc.first)} {}

HalfPlane HalfHull::side() const {
  if (is_first_) return {line_.normal_x, line_.normal_y, line_.offset};
  const float below = std::nextafter(-line_.offset, -std::numeric_limits<float>::infinity());
  return {-line_.normal_x, -line_.normal_y, below};
}

void HalfHull::add(const std::vector<Vector2d>& points) {
  const auto& [from, to] = chord_;
  std::vector<Vector2d> beyond = cap_;
  for (const Vector2d& p : points) {
    const bool is_beyond = chord_.isPoint() ? p != from : chord_.areaWith(p) > 0.0;
    if (is_beyond && isFirst(line_, p) == is_first_) beyond.push_back(p);
  }
  if (beyond.size() == cap_.size()) return;
  const Vector2d outward(line_.normal_x, line_.normal_y);
  cap_ = chord_.isPoint() ? hullFrom(from, is_first_ ? outward : Vector2d(-outward), std::move(beyond))
                          : hullBeyond(from, to, std::move(beyond));
}

Polygon HalfHull::closedCap() const {
  Polygon closed{chord_.from};
  closed.insert(closed.end(), cap_.begin(), cap_.end());
  closed.push_back(chord_.to);
  return closed;
}

double HalfHull::area() const { return arc_area_ + signedArea(closedCap()); }

Region HalfHull::inside() const {
  Region region;
  if (chord_.isPoint() && cap_.empty()) region.push_back(kNowhere);
  const Polygon closed = closedCap();
  for (std::size_t i = 0; i + 1 < closed.size(); ++i) {
    if (closed[i] != closed[i + 1]) region.push_back(leftOf(closed[i], closed[i + 1]));
  }
  region.push_back(side());
  return region;
}

std::optional<Sides> Sides::of(const HullArcs& arcs, const Line& line) {
  const std::optional<Arc> first = firstArc(arcs, line);
  if (!first) return std::nullopt;
  const Arc second{arcs.next(first->last), arcs.previous(first->first)};
  return Sides(HalfHull(arcs, *first, line, true), HalfHull(arcs, second, line, false));
}

void Sides::add(const std::vector<Vector2d>& points) {
  first_.add(points);
  second_.add(points);
}

}  // namespace boxgrasp
