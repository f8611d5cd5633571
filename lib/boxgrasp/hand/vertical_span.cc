#include "boxgrasp/hand/vertical_span.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace boxgrasp {
namespace {

constexpr double kVertical = 1e-12;  // squared sine of the angle to z below which an axis counts as vertical

constexpr VerticalSpan kNothing{std::numeric_limits<double>::infinity(),
                                -std::numeric_limits<double>::infinity()};
constexpr VerticalSpan kAll{kNothing.high, kNothing.low};

VerticalSpan intersection(const VerticalSpan& x, const VerticalSpan& y) {
  return {std::max(x.low, y.low), std::min(x.high, y.high)};
}

VerticalSpan insideSphere(const Vector3d& center, double radius, const Vector2d& line) {
  const double rest = radius * radius - (line - center.head<2>()).squaredNorm();
  if (rest < 0) return kNothing;
  return {center.z() - std::sqrt(rest), center.z() + std::sqrt(rest)};
}

// Between the planes through a and b across the unit vector `axis`; `foot` is a point of the line, relative
// to a.
VerticalSpan betweenEnds(const Vector3d& foot, const Vector3d& axis, double length) {
  const double at_foot = foot.dot(axis);
  if (axis.z() == 0.0) return at_foot >= 0 && at_foot <= length ? kAll : kNothing;
  const double z0 = (0.0 - at_foot) / axis.z(), z1 = (length - at_foot) / axis.z();
  return {std::min(z0, z1), std::max(z0, z1)};
}

// Within `radius` of the endless line along `axis` through the origin; the squared distance is quadratic in
// z.
VerticalSpan insideCylinder(const Vector3d& foot, const Vector3d& axis, double radius) {
  const double at_foot = foot.dot(axis);
  const double quadratic = 1.0 - axis.z() * axis.z();
  const double linear = foot.z() - at_foot * axis.z();
  const double constant = foot.squaredNorm() - at_foot * at_foot - radius * radius;
  if (quadratic < kVertical) return constant <= 0 ? kAll : kNothing;
  const double discriminant = linear * linear - quadratic * constant;
  if (discriminant < 0) return kNothing;
  const double half = std::sqrt(discriminant);
  return {(-linear - half) / quadratic, (-linear + half) / quadratic};
}

// z relative to a.
VerticalSpan insideTrunk(const Vector3d& a, const Vector3d& b, double radius, const Vector2d& line) {
  const double length = (b - a).norm();
  if (length == 0.0) return kNothing;
  const Vector3d axis = (b - a) / length, foot(line.x() - a.x(), line.y() - a.y(), 0.0);
  const VerticalSpan trunk =
      intersection(betweenEnds(foot, axis, length), insideCylinder(foot, axis, radius));
  return {trunk.low + a.z(), trunk.high + a.z()};
}

}  // namespace

std::optional<VerticalSpan> verticalSpan(const Vector3d& a, const Vector3d& b, double radius,
                                         const Vector2d& line) {
  // The capsule is convex, so what lies in its parts joins to one span.
  VerticalSpan whole = kNothing;
  for (const VerticalSpan& part :
       {insideSphere(a, radius, line), insideSphere(b, radius, line), insideTrunk(a, b, radius, line)}) {
    if (part.low > part.high) continue;
    whole = {std::min(whole.low, part.low), std::max(whole.high, part.high)};
  }
  if (whole.low > whole.high) return std::nullopt;
  return whole;
}

}  // namespace boxgrasp
