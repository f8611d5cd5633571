// The surface of a cloud near a point, as a plane.
#pragma once

#include <optional>

#include "boxgrasp/geometry/point_grid.h"

namespace boxgrasp {

// The plane of least squares through some points.
struct SurfacePlane {
  Vector3d centroid = Vector3d::Constant(NAN);
  Vector3d normal = Vector3d::Constant(NAN);  // unit; its sign is arbitrary
  double flatness = -1.0;  // least variance over the sum of the three: 0 for a plane, 1/3 for a round cluster

  Vector3d project(const Vector3d& p) const { return p - normal.dot(p - centroid) * normal; }
};

// The plane through the points within `radius_m` of p, by their principal axes. nullopt when they do not span
// a plane: fewer than three, or all on a line to within a millionth of their extent.
std::optional<SurfacePlane> fitSurface(const PointGrid& grid, const Vector3d& p, double radius_m);

}  // namespace boxgrasp
