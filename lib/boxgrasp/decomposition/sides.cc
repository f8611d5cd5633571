#include "boxgrasp/decomposition/sides.h"

#include <algorithm>

namespace boxgrasp {
namespace {

HalfPlane leftOf(const Vector2d& from, const Vector2d& to) {
  const Vector2d along = (to - from).normalized(), outward(along.y(), -along.x());
  return {static_cast<float>(outward.x()), static_cast<float>(outward.y()),
          static_cast<float>(outward.dot(from))};
}

bool isFirst(const Line& line, const Vector2d& p) {
  return line.isFirst(static_cast<float>(p.x()), static_cast<float>(p.y()));
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

bool lexicographic(const Vector2d& a, const Vector2d& b) {
  return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
}

Region insideOf(const Polygon& polygon) {
  if (polygon.size() < 3) return {{0.0f, 0.0f, -1.0f}};
  Region region;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    region.push_back(leftOf(polygon[i], polygon[(i + 1) % polygon.size()]));
  return region;
}

HalfHull::HalfHull(const HullArcs& arcs, const Arc& arc, const HalfPlane& side)
    : side_(side),
      arc_area_(arcs.area(arc)),
      from_(arcs.at(arc.last)),
      to_(arcs.at(arc.first)),
      is_vertex_(arc.first == arc.last) {
  cap_ = {from_};
  if (!is_vertex_) cap_.push_back(to_);
}

void HalfHull::add(const std::vector<Vector2d>& points) {
  std::vector<Vector2d> beyond;
  for (const Vector2d& p : points) {
    if (isBeyondChord(p)) beyond.push_back(p);
  }
  if (beyond.empty()) return;
  std::sort(cap_.begin(), cap_.end(), lexicographic);
  std::vector<Vector2d> all(cap_.size() + beyond.size());
  std::merge(cap_.begin(), cap_.end(), beyond.begin(), beyond.end(), all.begin(), lexicographic);
  cap_ = convexHull(std::move(all));
}

Region HalfHull::inside() const {
  Region region;
  if (is_vertex_ || cap_.size() < 3) {
    region = is_vertex_ ? insideOf(cap_) : Region{leftOf(from_, to_)};
  } else {
    for (std::size_t i = 0; i < cap_.size(); ++i) {
      const Vector2d &a = cap_[i], &b = cap_[(i + 1) % cap_.size()];
      if (a != to_ || b != from_) region.push_back(leftOf(a, b));
    }
  }
  region.push_back(side_);
  return region;
}

std::optional<Sides> Sides::of(const HullArcs& arcs, const Line& line) {
  const std::optional<Arc> first = firstArc(arcs, line);
  if (!first) return std::nullopt;
  const Arc second{arcs.next(first->last), arcs.previous(first->first)};
  return Sides(line, HalfHull(arcs, *first, {line.normal_x, line.normal_y, line.offset}),
               HalfHull(arcs, second, {-line.normal_x, -line.normal_y, -line.offset}));
}

void Sides::add(std::vector<Vector2d> points) {
  if (!std::ranges::is_sorted(points, lexicographic)) std::ranges::sort(points, lexicographic);
  std::vector<Vector2d> first, second;
  for (const Vector2d& p : points) (isFirst(line_, p) ? first : second).push_back(p);
  first_.add(first);
  second_.add(second);
}

}  // namespace boxgrasp
