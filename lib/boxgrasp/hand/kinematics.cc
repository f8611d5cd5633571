#include "boxgrasp/hand/kinematics.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace boxgrasp {
namespace {

// Angles of a finger's two links above the plane of the palm, and how fast the outer one turns with the
// joint.
struct LinkAngles {
  double inner, outer;
  double outer_rate;
};

LinkAngles linkAngles(const HandDescription& hand, double joint) {
  const double coupled = hand.coupling * joint;
  const bool at_limit = coupled > hand.outer_max;
  const double inner = joint + hand.inner_rest;
  return {inner, inner + hand.outer_rest + std::min(coupled, hand.outer_max),
          at_limit ? 1.0 : 1.0 + hand.coupling};
}

Vector2d along(double length, double angle) { return {length * std::cos(angle), length * std::sin(angle)}; }

// The fingertip in the finger's plane, and its derivatives by the joint angle.
struct TipMotion {
  Vector2d at, rate, bend;
};

TipMotion tipMotion(const HandDescription& hand, double joint) {
  if (hand.prismatic()) {
    return {{hand.tip_radius - hand.slide_per_rad * joint, hand.inner_length + hand.tip_length},
            {-hand.slide_per_rad, 0.0},
            {0.0, 0.0}};
  }
  const LinkAngles angles = linkAngles(hand, joint);
  const Vector2d inner = along(hand.inner_length, angles.inner), outer = along(hand.tip_length, angles.outer);
  const double rate = angles.outer_rate;
  return {inner + outer,
          {-inner.y() - rate * outer.y(), inner.x() + rate * outer.x()},
          -inner - rate * rate * outer};
}

double extensionRate(const HandDescription& hand, double joint) { return tipMotion(hand, joint).rate.x(); }

constexpr double kReachRounding = 1e-12;  // metres; an extension at the very end of the reach is in reach
constexpr int kMaxIterations = 100;       // bisection alone needs 55
constexpr double kSettled_rad = 1e-11;    // a step so small ends at the angle to rounding

// The names of the three links of F1, F2 and the thumb; of jaws: of rail, stem and pad.
constexpr std::string_view kLinkNames[3][3] = {{"F1 knuckle", "F1 inner link", "F1 outer link"},
                                               {"F2 knuckle", "F2 inner link", "F2 outer link"},
                                               {"thumb knuckle", "thumb inner link", "thumb outer link"}};

void placeFinger(const HandDescription& hand, int finger, double joint, const FingerPlane& plane,
                 Capsule* links) {
  const auto& names = kLinkNames[finger];
  const Vector3d inner_joint = plane.at({0, 0});
  const Vector3d outer_joint = plane.at(along(hand.inner_length, linkAngles(hand, joint).inner));
  links[0] = {names[0], finger, plane.base(), inner_joint, hand.knuckle_radius};
  links[1] = {names[1], finger, inner_joint, outer_joint, hand.inner_radius};
  links[2] = {names[2], finger, outer_joint, plane.at(fingertipInPlane(hand, joint)), hand.outer_radius};
}

void placeJaw(const HandDescription& hand, int finger, double joint, const FingerPlane& plane,
              Capsule* links) {
  const auto& names = kLinkNames[finger];
  const Vector2d tip = fingertipInPlane(hand, joint);
  const Vector3d foot = plane.at({tip.x(), 0}), pad = plane.at({tip.x(), hand.inner_length}),
                 end = plane.at(tip), across(hand.spread_offset, 0, 0);
  const bool thumb = finger == kThumb;
  links[0] = {names[0], finger, plane.base(), plane.at({hand.tip_radius, 0}), hand.knuckle_radius};
  links[1] = {names[1], finger, foot, thumb ? end : pad, hand.inner_radius};
  links[2] = {names[2], finger, thumb ? end - across : pad, thumb ? end + across : end, hand.outer_radius};
}

}  // namespace

FingerPlane::FingerPlane(const HandDescription& hand, Finger finger, double spread)
    : base_((finger == kF1   ? 1.0
             : finger == kF2 ? -1.0
                             : 0.0) *
                hand.spread_offset,
            0.0),
      direction_(fingerDirection(finger, spread)),
      radius_(hand.base_radius),
      height_(hand.joint_height) {}

Vector3d FingerPlane::at(const Vector2d& in_plane) const {
  const Vector2d p = base_ + (radius_ + in_plane.x()) * direction_;
  return {p.x(), p.y(), height_ + in_plane.y()};
}

Vector3d FingerPlane::coordinates(const Vector3d& p_P) const {
  const Vector2d p = p_P.head<2>() - base_;
  return {p.dot(direction_) - radius_, p_P.z() - height_, p.x() * direction_.y() - p.y() * direction_.x()};
}

Vector2d fingertipInPlane(const HandDescription& hand, double inner) { return tipMotion(hand, inner).at; }

double extension(const HandDescription& hand, double inner) {
  return fingertipInPlane(hand, inner).x() - hand.tip_radius;
}

double maxMonotoneAngle(const HandDescription& hand) {
  if (extensionRate(hand, hand.inner_max) < 0) return hand.inner_max;
  double falling = hand.inner_min, rising = hand.inner_max;
  for (double mid = 0.5 * (falling + rising); mid > falling && mid < rising; mid = 0.5 * (falling + rising)) {
    (extensionRate(hand, mid) < 0 ? falling : rising) = mid;
  }
  return falling;
}

Reach fingerReach(const HandDescription& hand) {
  Reach reach;
  reach.inner_min = hand.inner_min;
  reach.inner_max = maxMonotoneAngle(hand);
  for (int step = 0; step <= Reach::kSteps; ++step)
    reach.extensions_m[step] = extension(hand, reach.inner(step));
  reach.extension_min_m = reach.extensions_m.back();
  reach.extension_max_m = reach.extensions_m.front();
  return reach;
}

std::optional<double> innerForExtension(const HandDescription& hand, double extension_m) {
  return innerForExtension(hand, extension_m, fingerReach(hand));
}

std::optional<double> innerForExtension(const HandDescription& hand, double extension_m, const Reach& reach) {
  const bool reached = extension_m >= reach.extension_min_m - kReachRounding &&
                       extension_m <= reach.extension_max_m + kReachRounding;
  if (!reached) return std::nullopt;
  // Halley's method from where the chord of the step crosses, kept inside a bracket: near the end of the
  // monotone range the slope vanishes, and it jumps where the outer joint comes to its limit.
  const auto& steps = reach.extensions_m;
  const auto behind = std::lower_bound(steps.begin() + 1, steps.end() - 1, extension_m, std::greater{});
  const double share = (behind[-1] - extension_m) / (behind[-1] - behind[0]);
  const auto step = static_cast<double>(behind - steps.begin());
  double low = reach.inner(step - 1), high = reach.inner(step);
  double joint = reach.inner(step - 1 + std::clamp(share, 0.0, 1.0));
  for (int i = 0; i < kMaxIterations; ++i) {
    const TipMotion tip = tipMotion(hand, joint);
    const double excess = tip.at.x() - hand.tip_radius - extension_m;
    if (excess == 0.0) return joint;
    (excess > 0 ? low : high) = joint;
    const double rate = tip.rate.x();
    const double halley = joint - 2 * excess * rate / (2 * rate * rate - excess * tip.bend.x());
    const double next = halley >= low && halley <= high ? halley : 0.5 * (low + high);
    if (std::abs(next - joint) < kSettled_rad) return next;
    joint = next;
  }
  return joint;
}

double tipHeight(const HandDescription& hand, double inner) {
  return hand.joint_height + fingertipInPlane(hand, inner).y();
}

double linearDepth(const HandDescription& hand, double extension_m) {
  return hand.depth_slope * extension_m + hand.depth_offset;
}

Vector2d fingerDirection(Finger finger, double spread) {
  if (finger == kThumb) return {0.0, -1.0};
  return {(finger == kF1 ? 1.0 : -1.0) * std::sin(spread), std::cos(spread)};
}

HandGeometry forwardKinematics(const HandDescription& hand, const HandJoints& joints) {
  HandGeometry geometry;
  geometry.palm_radius = hand.palm_radius;
  geometry.palm_thickness = hand.palm_thickness;
  for (int finger = 0; finger < 3; ++finger) {
    const FingerPlane plane(hand, static_cast<Finger>(finger), joints.spread);
    const double joint = joints.inner[finger];
    (hand.prismatic() ? placeJaw : placeFinger)(hand, finger, joint, plane, &geometry.links[3 * finger]);
    geometry.tips_P[finger] = plane.at(fingertipInPlane(hand, joint));
  }
  return geometry;
}

}  // namespace boxgrasp
