// The part of a vertical line inside a capsule: the exact building block of the swept clearance test.
#pragma once

#include <optional>

#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

struct VerticalSpan {
  double low, high;  // z
};

// Of the line parallel to z through `line`, what lies within `radius` of the segment from a to b; nullopt:
// nothing. Exact, for segments of any direction, points included. Pre: radius >= 0.
std::optional<VerticalSpan> verticalSpan(const Vector3d& a, const Vector3d& b, double radius,
                                         const Vector2d& line);

}  // namespace boxgrasp
