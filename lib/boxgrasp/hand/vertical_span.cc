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

// Between the planes through both ends of the axis, across it; `foot` is a point of the line, relative to the
// first end.
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

}  // namespace

CapsuleSpans::CapsuleSpans(const Vector3d& a, const Vector3d& b, double radius)
    : a_(a), b_(b), radius_(radius), length_((b - a).norm()), axis_((b - a).normalized()) {
  sideways_ = Vector2d(-axis_.y(), axis_.x()).normalized();
}

std::optional<VerticalSpan> CapsuleSpans::at(const Vector2d& line) const {
  // Most lines that are asked for pass the capsule by.
  if (std::abs(sideways_.dot(line - a_.head<2>())) > radius_) return std::nullopt;
  // The capsule is convex, so what lies in its parts joins to one span.
  VerticalSpan whole = kNothing;
  for (const VerticalSpan& part : {insideSphere(a_, line), insideSphere(b_, line), insideTrunk(line)}) {
    if (part.low > part.high) continue;
    whole = {std::min(whole.low, part.low), std::max(whole.high, part.high)};
  }
  if (whole.low > whole.high) return std::nullopt;
  return whole;
}

VerticalSpan CapsuleSpans::insideSphere(const Vector3d& center, const Vector2d& line) const {
  const double rest = radius_ * radius_ - (line - center.head<2>()).squaredNorm();
  if (rest < 0) return kNothing;
  return {center.z() - std::sqrt(rest), center.z() + std::sqrt(rest)};
}

VerticalSpan CapsuleSpans::insideTrunk(const Vector2d& line) const {
  if (length_ == 0.0) return kNothing;
  const Vector3d foot(line.x() - a_.x(), line.y() - a_.y(), 0.0);
  const VerticalSpan ends = betweenEnds(foot, axis_, length_), sides = insideCylinder(foot, axis_, radius_);
  return {a_.z() + std::max(ends.low, sides.low), a_.z() + std::min(ends.high, sides.high)};
}

}  // namespace boxgrasp
