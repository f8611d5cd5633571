#include "boxgrasp/hand/clearance.h"

#include <algorithm>
#include <cassert>
#include <numbers>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/tolerances.h"
#include "boxgrasp/hand/swept_capsule.h"

namespace boxgrasp {
namespace {

constexpr std::string_view kApproaching = "approaching", kClosing = "closing", kInPlace = "in place";
constexpr std::array<int, 3> kKnuckles{0, 3, 6};
constexpr std::array<int, 6> kFingerLinks{1, 2, 4, 5, 7, 8};
bool isOuterLink(int link) { return link % 3 == 2; }

// A hand of one grasp among the points of a scene.
class Test {
 public:
  Test(const HandDescription& hand, const Pose& X_AP, const HandJoints& closed,
       const ApproachColumns& scene_A, const ClearanceOptions& options)
      : hand_(hand), X_AP_(X_AP), closed_(closed), scene_A_(scene_A), options_(options) {}

  Clearance run() const {
    if (auto met = whateverTheOpening()) return {{}, met};
    Clearance result;
    for (const double opening : options_.openings_rad) {
      const HandJoints open = opened(opening);
      auto met = approaching(open);
      if (!met) met = closing(open);
      if (!met) return {open, {}};
      if (!result.collision || (met->phase == kClosing && result.collision->phase == kApproaching))
        result.collision = met;
    }
    return result;
  }

 private:
  HandJoints opened(double opening) const {
    HandJoints open = closed_;
    for (double& joint : open.inner)
      joint = std::max(hand_.inner_min, std::min(opening, joint - options_.min_opening_rad));
    return open;
  }

  // The palm and the knuckles do not depend on the fingers' joints: their way in is tested here, their place
  // is its end.
  std::optional<Collision> whateverTheOpening() const {
    const HandGeometry pose = forwardKinematics(hand_, closed_);
    if (auto met = palmMeets()) return met;
    for (const int link : kKnuckles) {
      if (auto met = meets(pose.links[link], options_.skin_m, options_.approach_m, kApproaching)) return met;
    }
    for (const int link : kFingerLinks) {
      const double thinning = isOuterLink(link) ? options_.contact_m : options_.skin_m;
      if (auto met = meets(pose.links[link], thinning, 0.0, kInPlace)) return met;
    }
    return std::nullopt;
  }

  std::optional<Collision> approaching(const HandJoints& open) const {
    return fingersMeet(open, options_.approach_m, kApproaching);
  }

  std::optional<Collision> closing(const HandJoints& open) const {
    for (int step = 1; step <= options_.closing_steps; ++step) {
      const double share = static_cast<double>(step) / (options_.closing_steps + 1);
      HandJoints joints = closed_;
      for (int finger = 0; finger < 3; ++finger)
        joints.inner[finger] = std::lerp(open.inner[finger], closed_.inner[finger], share);
      if (auto met = fingersMeet(joints, 0.0, kClosing)) return met;
    }
    return std::nullopt;
  }

  std::optional<Collision> fingersMeet(const HandJoints& joints, double sweep_m,
                                       std::string_view phase) const {
    const HandGeometry pose = forwardKinematics(hand_, joints);
    for (const int link : kFingerLinks) {
      if (auto met = meets(pose.links[link], options_.skin_m, sweep_m, phase)) return met;
    }
    return std::nullopt;
  }

  // Whether the link, thinned, meets a point anywhere on its last `sweep_m` along z.
  std::optional<Collision> meets(const Capsule& link, double thinning_m, double sweep_m,
                                 std::string_view phase) const {
    const double radius = link.radius - thinning_m;
    if (radius <= 0) return std::nullopt;
    const Vector3d a_A = X_AP_ * link.a, b_A = X_AP_ * link.b, margin = Vector3d::Constant(radius);
    Eigen::AlignedBox3d box_A(a_A.cwiseMin(b_A) - margin, a_A.cwiseMax(b_A) + margin);
    box_A.min().z() -= sweep_m;
    const SweptCapsule capsule(a_A, b_A, radius, sweep_m);
    return firstMet(box_A, link.name, phase, [&](const Vector3d& p_A) { return capsule.contains(p_A); });
  }

  std::optional<Collision> palmMeets() const {
    const double radius = hand_.palm_radius - options_.skin_m;
    if (radius <= 0) return std::nullopt;
    const Vector3d center_A = X_AP_.translation();
    const Vector3d low(radius, radius, hand_.palm_thickness + options_.approach_m),
        high(radius, radius, -options_.skin_m);
    return firstMet({center_A - low, center_A + high}, "palm", kApproaching, [&](const Vector3d& p_A) {
      return (p_A - center_A).head<2>().squaredNorm() <= radius * radius;
    });
  }

  template <typename Inside>
  std::optional<Collision> firstMet(const Eigen::AlignedBox3d& box_A, std::string_view link,
                                    std::string_view phase, Inside&& inside) const {
    std::optional<Collision> met;
    scene_A_.visit(box_A, [&](const Eigen::Vector3f& point_A) {
      const Vector3d p_A = point_A.cast<double>();
      if (!inside(p_A)) return false;
      met = Collision{link, phase, scene_A_.X_CA() * p_A};
      return true;
    });
    return met;
  }

  const HandDescription& hand_;
  const Pose& X_AP_;
  const HandJoints& closed_;
  const ApproachColumns& scene_A_;
  const ClearanceOptions& options_;
};

}  // namespace

void ClearanceOptions::validate() const {
  requireOption(approach_m >= 0 && approach_m <= 10, "clearance.approach_m", approach_m, "in [0, 10]");
  requireOption(skin_m >= 0 && skin_m <= 1, "clearance.skin_m", skin_m, "in [0, 1]");
  requireOption(contact_m >= 0 && contact_m <= 1, "clearance.contact_m", contact_m, "in [0, 1]");
  for (const double opening : openings_rad)
    requireOption(opening >= 0 && opening <= std::numbers::pi, "clearance.openings_rad", opening,
                  "in [0, pi]");
  requireOption(min_opening_rad >= 0 && min_opening_rad <= std::numbers::pi, "clearance.min_opening_rad",
                min_opening_rad, "in [0, pi]");
  requireOption(closing_steps >= 0 && closing_steps <= 10000, "clearance.closing_steps", closing_steps,
                "in [0, 10000]");
}

Eigen::AlignedBox3d reachableRegion(const HandDescription& hand, const Eigen::AlignedBox3d& origins_A,
                                    const ClearanceOptions& options) {
  const double finger = hand.inner_length + hand.tip_length + std::max(hand.inner_radius, hand.outer_radius);
  const double knuckle = hand.spread_offset + hand.base_radius;
  const double side = std::max(hand.palm_radius, knuckle + std::max(finger, hand.knuckle_radius));
  const double above = std::max(hand.palm_thickness, finger - hand.joint_height) + options.approach_m;
  const double below = std::max(hand.joint_height + std::max(finger, hand.knuckle_radius), 0.0);
  return {origins_A.min() - Vector3d(side, side, above), origins_A.max() + Vector3d(side, side, below)};
}

Clearance testClearance(const HandDescription& hand, const Pose& X_AP, const HandJoints& closed,
                        const ApproachColumns& scene_A, const ClearanceOptions& options) {
  assert((X_AP.linear().col(2) - Vector3d::UnitZ()).norm() < tolerance::kUnitVector);
  return Test(hand, X_AP, closed, scene_A, options).run();
}

Clearance testClearance(const HandDescription& hand, const Pose& X_CP, const HandJoints& closed,
                        const PointGrid& scene_C, const ClearanceOptions& options) {
  const Eigen::AlignedBox3d origin_P(Vector3d::Zero(), Vector3d::Zero());
  const ApproachColumns scene_P(scene_C, X_CP, reachableRegion(hand, origin_P, options));
  return testClearance(hand, Pose::Identity(), closed, scene_P, options);
}

}  // namespace boxgrasp
