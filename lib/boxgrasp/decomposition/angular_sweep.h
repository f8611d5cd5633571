// Hull areas on both sides of every line through one point, in one sweep.
#pragma once

#include <vector>

#include "boxgrasp/geometry/polygon.h"

namespace boxgrasp {

// Sorts points by their angle around an apex on the edge of their hull. Then the points on either side of a
// line through the apex are the first or the last of them, and each point that a growing side takes in is a
// vertex of its hull: all areas together take O(m log m) for the sort and O(m) for the hulls. Buffers are
// kept from apex to apex.
class AngularSweep {
 public:
  // `inside` is any point within the hull, off its edge.
  void sweep(const std::vector<Vector2d>& points, const Vector2d& apex, const Vector2d& inside);

  // The summed area of the hulls of both sides of the line through the apex along `direction`. Points so near
  // to the line or the apex that rounding may put them on either side are left out: at most the true sum. 0
  // where the line goes on into the points behind the apex, as along an edge of the hull.
  double area(const Vector2d& direction) const;

 private:
  struct Ray {
    double angle, reach;
    Vector2d point;
  };
  // A hull that grows point by point: a ring of vertices, counter-clockwise.
  struct Ring {
    std::vector<std::size_t> next, previous;
    double twice_area = 0.0;
    std::size_t top = 0;  // taken in last
  };

  double angleOf(const Vector2d& direction) const;
  void sortRays(const std::vector<Vector2d>& points, const Vector2d& apex);
  void thinRays();
  void start(std::size_t ray);
  void take(std::size_t ray);
  double twiceArea(std::size_t a, std::size_t b, std::size_t c) const;

  Vector2d axis_{1, 0};
  std::vector<Ray> rays_;
  std::vector<double> first_, last_;  // twice the hull area of the first k rays; of those from k on
  Ring ring_;
};

}  // namespace boxgrasp
