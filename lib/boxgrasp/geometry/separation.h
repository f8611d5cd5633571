// Whether two convex bodies keep apart.
#pragma once

#include <functional>

#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

// A convex body by its support mapping: its point that is furthest in a direction (any length but 0).
using Support = std::function<Vector3d(const Vector3d& direction)>;

Support ballAround(const Vector3d& center, double radius);
Support capsuleBetween(const Vector3d& a, const Vector3d& b, double radius);
Support cylinderBetween(const Vector3d& a, const Vector3d& b, double radius);  // flat ends; a != b
Support alignedBox(const Eigen::AlignedBox3d& box);
// Everywhere that the body is while it moves straight by `way`.
Support swept(Support body, const Vector3d& way);

// True if a plane parts the bodies; false if they meet or are nearer than `margin_m`. Found by the search of
// Gilbert, Johnson and Keerthi (1988) for their nearest points; if 100 of its steps find no plane, the answer
// is false, to be on the safe side. Both are finite.
bool apart(const Support& a, const Support& b, double margin_m = 1e-4);

}  // namespace boxgrasp
