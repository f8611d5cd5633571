// The part of a vertical line inside a capsule: the exact building block of the swept clearance test.
#pragma once

#include <optional>

#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

struct VerticalSpan {
  double low, high;  // z
};

// A capsule, all points within `radius` of the segment from a to b, cut by lines parallel to z. Exact, for
// segments of any direction, points included.
class CapsuleSpans {
 public:
  // Pre: radius >= 0.
  CapsuleSpans(const Vector3d& a, const Vector3d& b, double radius);

  // Of the line through `line`, what lies in the capsule; nullopt: nothing.
  std::optional<VerticalSpan> at(const Vector2d& line) const;

 private:
  VerticalSpan insideSphere(const Vector3d& center, const Vector2d& line) const;
  VerticalSpan insideTrunk(const Vector2d& line) const;

  Vector3d a_, b_;
  double radius_, length_;
  Vector3d axis_;      // unit, from a to b; zero for a point
  Vector2d sideways_;  // unit, across the capsule in the plane; zero for an upright one
};

}  // namespace boxgrasp
