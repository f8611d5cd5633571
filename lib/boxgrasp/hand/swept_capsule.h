// A capsule that comes along z: the exact building block of the clearance test.
#pragma once

#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

// All points that a capsule covers on the last `sweep_m` of its way along +z to its place: those within
// `radius` of the segment from a to b, and those up to sweep_m below one. Exact, for segments of any
// direction, points included.
class SweptCapsule {
 public:
  // Pre: radius >= 0, sweep_m >= 0.
  SweptCapsule(const Vector3d& a, const Vector3d& b, double radius, double sweep_m);

  bool contains(const Vector3d& p) const;

 private:
  Vector3d a_, along_;        // the segment's first end, and from there to its second
  double per_squared_;        // 1 / |along|^2, or 0 for a point
  double per_squared_level_;  // the same of its shadow in the plane
  double squared_radius_, sweep_m_;
};

}  // namespace boxgrasp
