// A few points of a face, and how they make hulls grow.
#pragma once

#include <optional>
#include <vector>

#include "boxgrasp/decomposition/half_plane.h"

namespace boxgrasp {

// As many points as there are so far.
class PointPool {
 public:
  PointPool() = default;
  explicit PointPool(const std::vector<Vector2d>& points);

  void add(const Vector2d& p);

  // The point farthest beyond a half plane among those on a side; nothing where no point is.
  std::optional<Vector2d> farthestBeyond(const HalfPlane& inside, const HalfPlane& side) const;

  // Appends the points that are in the inside of neither of two regions, or nearer to an edge than a margin.
  void appendOpenPoints(const Region& a, const Region& b, float margin, std::vector<Vector2d>& points) const;

 private:
  std::size_t size_ = 0;
  std::vector<float> x_, y_;  // whole blocks, the last one filled up with its first point
};

// Grows a hull beyond its edges with the points of a pool that are on a side, as quickhull does.
class PoolGrowth {
 public:
  // Points nearer to an edge than the margin do not count. The pool is the owner's.
  PoolGrowth(const PointPool& pool, const HalfPlane& side, double margin)
      : pool_(pool), side_(side), margin_(margin) {}

  // The area gained beyond an edge with up to 2^depth - 1 points; visit(p) is called with each of them.
  // Pre: both ends are vertices of the hull of the points on the side.
  template <typename Visit>
  double beyond(const HullEdge& edge, int depth, const Visit& visit) const {
    const std::optional<Vector2d> p = pool_.farthestBeyond(edge.inside(side_), side_);
    if (!p) return 0.0;
    const double gained = edge.areaWith(*p);
    if (!edge.isPoint() && gained <= 0.5 * (edge.to - edge.from).norm() * margin_) return 0.0;
    visit(*p);
    if (depth == 1) return gained;
    return gained + beyond({edge.from, *p}, depth - 1, visit) + beyond({*p, edge.to}, depth - 1, visit);
  }

 private:
  const PointPool& pool_;
  HalfPlane side_;
  double margin_;
};

}  // namespace boxgrasp
