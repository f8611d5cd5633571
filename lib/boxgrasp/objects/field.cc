#include "boxgrasp/objects/field.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace boxgrasp {
namespace {

// How far along the segment from a to b the point of it next to p is, 0 to 1.
template <typename Vector>
double nearestOnSegment(const Vector& p, const Vector& a, const Vector& b) {
  const Vector ab = b - a;
  return std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
}

// Distance in the plane to a rectangle of the given half sizes about the origin.
double rectangleDistance(const Vector2d& p, const Vector2d& half_sizes) {
  const Vector2d q = p.cwiseAbs() - half_sizes;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

// Signed distance to a polygon of points (r, z), but for its edges on the axis r = 0, which are no surface of
// the solid of revolution. The sign is found by counting the edges that a ray to the right crosses.
double polygonDistance(const std::vector<Vector2d>& polygon, const Vector2d& p) {
  double squared = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vector2d &a = polygon[j], &b = polygon[i];
    if (a.x() == 0.0 && b.x() == 0.0) continue;
    squared = std::min(squared, (p - a - nearestOnSegment(p, a, b) * (b - a)).squaredNorm());
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) {
      inside = !inside;
    }
  }
  return inside ? -std::sqrt(squared) : std::sqrt(squared);
}

// The smaller of two distances, rounded where they differ by less than the radius (the quadratic smooth
// minimum).
double smoothMin(double a, double b, double radius) {
  const double overlap = std::max(radius - std::abs(a - b), 0.0) / radius;
  return std::min(a, b) - 0.25 * overlap * overlap * radius;
}

Field polyline(const std::vector<Vector3d>& points, const std::vector<double>& radii) {
  return [=](const Vector3d& p) {
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const double t = nearestOnSegment(p, points[i], points[i + 1]);
      const Vector3d on_axis = points[i] + t * (points[i + 1] - points[i]);
      distance = std::min(distance, (p - on_axis).norm() - (radii[i] + t * (radii[i + 1] - radii[i])));
    }
    return distance;
  };
}

}  // namespace

Field sphere(const Vector3d& center, double radius) {
  return [=](const Vector3d& p) { return (p - center).norm() - radius; };
}

Field ellipsoid(const Vector3d& center, const Vector3d& radii) {
  return [=](const Vector3d& p) {
    const Vector3d q = (p - center).cwiseQuotient(radii);
    const double k = q.norm(), slope = q.cwiseQuotient(radii).norm();
    return slope > 0.0 ? k * (k - 1.0) / slope : -radii.minCoeff();
  };
}

Field cone(const Vector3d& a, const Vector3d& b, double radius_a, double radius_b) {
  return tube({a, b}, {radius_a, radius_b});
}

Field capsule(const Vector3d& a, const Vector3d& b, double radius) { return cone(a, b, radius, radius); }

Field roundedBox(const Vector3d& center, const Vector3d& half_sizes, double rounding) {
  const Vector3d inner = half_sizes.array() - rounding;
  return [=](const Vector3d& p) {
    const Vector3d q = (p - center).cwiseAbs() - inner;
    return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - rounding;
  };
}

Field roundedCylinder(const Vector3d& center, const Vector3d& axis, double radius, double half_height,
                      double rounding) {
  const Vector2d inner(radius - rounding, half_height - rounding);
  return [=](const Vector3d& p) {
    const double along = (p - center).dot(axis);
    const double across = (p - center - along * axis).norm();
    return rectangleDistance({across, along}, inner) - rounding;
  };
}

Field torus(const Vector3d& center, const Vector3d& axis, double ring_radius, double tube_radius) {
  return [=](const Vector3d& p) {
    const double along = (p - center).dot(axis);
    const double across = (p - center - along * axis).norm();
    return std::hypot(across - ring_radius, along) - tube_radius;
  };
}

Field tube(const std::vector<Vector3d>& points, const std::vector<double>& radii) {
  assert(points.size() >= 2 && points.size() == radii.size());
  if (points.size() > 2) return polyline(smoothed(points), smoothed(radii));
  return polyline(points, radii);
}

Field revolved(const std::vector<Vector2d>& profile, double rounding) {
  return [=](const Vector3d& p) {
    return polygonDistance(profile, {std::hypot(p.x(), p.y()), p.z()}) - rounding;
  };
}

Field unite(std::vector<Field> parts) {
  return [parts = std::move(parts)](const Vector3d& p) {
    double distance = std::numeric_limits<double>::infinity();
    for (const Field& part : parts) distance = std::min(distance, part(p));
    return distance;
  };
}

Field blend(std::vector<Field> parts, double radius) {
  return [parts = std::move(parts), radius](const Vector3d& p) {
    double distance = parts.front()(p);
    for (std::size_t i = 1; i < parts.size(); ++i) distance = smoothMin(distance, parts[i](p), radius);
    return distance;
  };
}

Field subtract(Field from, Field what, double fillet) {
  return [=](const Vector3d& p) { return -smoothMin(-from(p), what(p), fillet); };
}

Field moved(Field field_B, const Pose& X_AB) {
  return [field_B = std::move(field_B), X_BA = X_AB.inverse()](const Vector3d& p_A) {
    return field_B(X_BA * p_A);
  };
}

}  // namespace boxgrasp
