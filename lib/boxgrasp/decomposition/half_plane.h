// Half planes, as single precision passes over points want them.
#pragma once

#include <vector>

#include "boxgrasp/geometry/polygon.h"

namespace boxgrasp {

// The points where normal.p <= offset.
struct HalfPlane {
  float normal_x = 0.0f, normal_y = 0.0f;
  float offset = 0.0f;
};

// Holds no point.
inline constexpr HalfPlane kNowhere{0.0f, 0.0f, -1.0f};

// What all of its half planes have in common.
using Region = std::vector<HalfPlane>;

// What is on the left of the way from one point to another. Pre: they differ.
inline HalfPlane leftOf(const Vector2d& from, const Vector2d& to) {
  const Vector2d along = (to - from).normalized(), outward(along.y(), -along.x());
  return {static_cast<float>(outward.x()), static_cast<float>(outward.y()),
          static_cast<float>(outward.dot(from))};
}

// An edge of a hull on a side: the part of the hull that is there is on the left of the way from one end to
// the other. Where the hull is but a point, both ends are the same.
struct HullEdge {
  Vector2d from{0, 0}, to{0, 0};

  bool isPoint() const { return from == to; }

  // Where points do not make the hull grow beyond the edge; beyond a point is what is further out on its
  // side. Its normal has some length.
  HalfPlane inside(const HalfPlane& side) const {
    if (isPoint()) return insideAlong({side.normal_x, side.normal_y});
    return insideAlong({to.y() - from.y(), from.x() - to.x()});
  }

  // The area of the triangle with a point beyond the edge.
  double areaWith(const Vector2d& beyond) const { return -0.5 * cross(to - from, beyond - from); }

 private:
  HalfPlane insideAlong(const Vector2d& outward) const {
    return {static_cast<float>(outward.x()), static_cast<float>(outward.y()),
            static_cast<float>(outward.dot(from))};
  }
};

}  // namespace boxgrasp
