#include "boxgrasp/decomposition/sides.h"

#include <algorithm>

namespace boxgrasp {
namespace {

HalfPlane leftOf(const Vector2d& from, const Vector2d& to) {
  const Vector2d along = (to - from).normalized(), outward(along.y(), -along.x());
  return {static_cast<float>(outward.x()), static_cast<float>(outward.y()),
          static_cast<float>(outward.dot(from))};
}

}  // namespace

void part(const std::vector<Vector2d>& points, const Line& line, Sides& sides) {
  for (const Vector2d& p : points) {
    const bool first = line.isFirst(static_cast<float>(p.x()), static_cast<float>(p.y()));
    (first ? sides.first : sides.second).push_back(p);
  }
}

Sides hullsOf(Sides sides) {
  return {convexHull(std::move(sides.first)), convexHull(std::move(sides.second))};
}

double thetaOf(const Sides& hulls, const FaceProjection& face) {
  return (signedArea(hulls.first) + signedArea(hulls.second)) / face.area;
}

bool lexicographic(const Vector2d& a, const Vector2d& b) {
  return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
}

void EdgeSet::assign(const Polygon& hull) {
  edges_.clear();
  for (std::size_t i = 0; i < hull.size(); ++i) edges_.emplace_back(hull[i], hull[(i + 1) % hull.size()]);
  std::sort(edges_.begin(), edges_.end(),
            [](const auto& a, const auto& b) { return lexicographic(a.first, b.first); });
}

bool EdgeSet::has(const Vector2d& from, const Vector2d& to) const {
  const auto found = std::partition_point(edges_.begin(), edges_.end(),
                                          [&](const auto& edge) { return lexicographic(edge.first, from); });
  return found != edges_.end() && found->first == from && found->second == to;
}

Region insideOf(const Polygon& polygon, const EdgeSet& outermost) {
  if (polygon.size() < 3) return {{0.0f, 0.0f, -1.0f}};
  Region region;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    if (!outermost.has(from, to)) region.push_back(leftOf(from, to));
  }
  return region;
}

}  // namespace boxgrasp
