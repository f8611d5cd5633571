// Shapes as implicit functions: signed distances that are combined by formula.
#pragma once

#include <functional>
#include <vector>

#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

// Negative inside, positive outside; about the distance to the surface, in the unit of the points. Only the
// sign is exact everywhere.
using Field = std::function<double(const Vector3d&)>;

// The line through the points with its corners cut twice (Chaikin), from the same first to the same last
// point. For points in the plane or space, or numbers.
template <typename T>
std::vector<T> smoothed(std::vector<T> points) {
  for (int round = 0; round < 2; ++round) {
    std::vector<T> cut{points.front()};
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      cut.push_back(0.75 * points[i] + 0.25 * points[i + 1]);
      cut.push_back(0.25 * points[i] + 0.75 * points[i + 1]);
    }
    cut.push_back(points.back());
    points = std::move(cut);
  }
  return points;
}

// --- primitives

Field sphere(const Vector3d& center, double radius);
// The first-order estimate of the distance.
Field ellipsoid(const Vector3d& center, const Vector3d& radii);
// A capsule from a to b whose radius changes linearly.
Field cone(const Vector3d& a, const Vector3d& b, double radius_a, double radius_b);
Field capsule(const Vector3d& a, const Vector3d& b, double radius);
// Half sizes include the rounding.
Field roundedBox(const Vector3d& center, const Vector3d& half_sizes, double rounding);
// Around the axis (unit) through `center`; half_height includes the rounding.
Field roundedCylinder(const Vector3d& center, const Vector3d& axis, double radius, double half_height,
                      double rounding);
Field torus(const Vector3d& center, const Vector3d& axis, double ring_radius, double tube_radius);
// A tube along the points, of the radius given at each, its bends rounded as by smoothed(). Pre: at least 2
// points, a radius each.
Field tube(const std::vector<Vector3d>& points, const std::vector<double>& radii);
// The solid of revolution about the z axis of a simple polygon of points (r, z), r >= 0, grown by `rounding`.
Field revolved(const std::vector<Vector2d>& profile, double rounding);

// --- combinations

Field unite(std::vector<Field> parts);
// With a fillet of about `radius` where the parts meet.
Field blend(std::vector<Field> parts, double radius);
Field subtract(Field from, Field what, double fillet);
// The field of the shape moved to the pose X_AB: `field` is in B, the result in A.
Field moved(Field field_B, const Pose& X_AB);

}  // namespace boxgrasp
