#include "boxgrasp/simulation/touch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace boxgrasp {
namespace {

constexpr double kSphereSpacing = 0.001;  // along a link: touches move evenly along it
constexpr double kPalmSpacing = 0.006;    // over the palm: an edge sinks in by 0.9 mm at most
constexpr double kPalmRounding = 0.010;   // of the palm's rim
constexpr double kApart = 0.008;          // touches nearer than this to another are no touch of their own

void enclose(HandPart& part) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : part.centers_B) box.extend(p);
  part.middle_B = box.center();
  part.reach = 0.5 * box.diagonal().norm() + part.radius;
}

// All touches of the spheres. Distances change by no more than one goes, so that a gap lets the next spheres
// be skipped.
std::vector<Touch> allTouches(const HandPart& part, const Pose& X_OB, const DistanceField& field) {
  std::vector<Touch> found;
  Vector3d last_B = Vector3d::Zero();
  double gap = 0.0;
  for (const Vector3d& center_B : part.centers_B) {
    if (gap > 0 && (center_B - last_B).squaredNorm() < gap * gap) continue;
    const Vector3d center_O = X_OB * center_B;
    const FieldValue value = field.valueAndGradient(center_O);
    gap = value.distance - part.radius;
    last_B = center_B;
    if (!(gap < 0)) continue;
    found.push_back({center_O - value.distance * value.gradient_O, -value.gradient_O, -gap});
  }
  return found;
}

double distanceToNearest(const std::vector<Touch>& chosen, const Touch& touch) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Touch& other : chosen) nearest = std::min(nearest, (other.p_O - touch.p_O).norm());
  return nearest;
}

}  // namespace

HandPart linkPart(const Capsule& link) {
  HandPart part{link.name, link.finger, link.radius, {}, {}, -1.0};
  const int steps = static_cast<int>(std::ceil((link.b - link.a).norm() / kSphereSpacing));
  for (int i = 0; i <= steps; ++i) {
    part.centers_B.push_back(link.a + static_cast<double>(i) / std::max(steps, 1) * (link.b - link.a));
  }
  enclose(part);
  return part;
}

HandPart palmPart(const HandDescription& hand) {
  const double radius = std::min(kPalmRounding, 0.5 * hand.palm_thickness);
  HandPart part{"palm", -1, radius, {}, {}, -1.0};
  const double flat = std::max(0.0, hand.palm_radius - radius);
  const int rings = static_cast<int>(std::ceil(flat / kPalmSpacing));
  for (int ring = 0; ring <= rings; ++ring) {
    for (int i = 0; i < std::max(1, 6 * ring); ++i) {
      const double angle = 2 * std::numbers::pi * i / std::max(1, 6 * ring),
                   r = flat * ring / std::max(1, rings);
      part.centers_B.emplace_back(r * std::cos(angle), r * std::sin(angle), -radius);
    }
  }
  enclose(part);
  return part;
}

HandPart moved(HandPart part_B, const Pose& X_AB) {
  for (Vector3d& center : part_B.centers_B) center = X_AB * center;
  part_B.middle_B = X_AB * part_B.middle_B;
  return part_B;
}

std::vector<Touch> touches(const HandPart& part, const Pose& X_OB, const DistanceField& field,
                           int max_touches) {
  if (field.distance(X_OB * part.middle_B) > part.reach) return {};
  const std::vector<Touch> all = allTouches(part, X_OB, field);
  std::vector<Touch> chosen;
  const auto deepest = std::max_element(all.begin(), all.end(),
                                        [](const Touch& a, const Touch& b) { return a.depth < b.depth; });
  if (deepest != all.end()) chosen.push_back(*deepest);
  while (!chosen.empty() && static_cast<int>(chosen.size()) < max_touches) {
    const auto next = std::max_element(all.begin(), all.end(), [&](const Touch& a, const Touch& b) {
      return distanceToNearest(chosen, a) < distanceToNearest(chosen, b);
    });
    if (distanceToNearest(chosen, *next) < kApart) break;
    chosen.push_back(*next);
  }
  return chosen;
}

SegmentPair closestPoints(const Vector3d& a1, const Vector3d& b1, const Vector3d& a2, const Vector3d& b2) {
  const Vector3d d1 = b1 - a1, d2 = b2 - a2, r = a1 - a2;
  const double l1 = d1.squaredNorm(), l2 = d2.squaredNorm(), along = d1.dot(d2);
  const auto onSegment = [](double numerator, double denominator) {
    return denominator > 0 ? std::clamp(numerator / denominator, 0.0, 1.0) : 0.0;
  };
  const double first = onSegment(along * d2.dot(r) - d1.dot(r) * l2, l1 * l2 - along * along);
  const double second = onSegment(d2.dot(r) + first * along, l2);
  return {a1 + onSegment(second * along - d1.dot(r), l1) * d1, a2 + second * d2};
}

}  // namespace boxgrasp
