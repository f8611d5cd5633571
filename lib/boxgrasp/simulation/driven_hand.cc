#include "boxgrasp/simulation/driven_hand.h"

#include <algorithm>
#include <cmath>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

// Of the links in a maker-based model, which sums to the hand's weight (definitions, 3.2).
constexpr double kInnerMass = 0.062, kOuterMass = 0.041;  // kg

// Share of the hand's limit that the motors press up to, so that what swings past it stays below the limit.
constexpr double kPressed = 0.93;

constexpr double kServoRate = 100.0;  // 1/s: how fast a joint's servo removes its error

// A jaw of a common gripper. Its slider keeps it from turning, so that its inertia matters little.
constexpr double kJawMass = 0.1;     // kg
constexpr double kJawLever = 0.03;   // m
constexpr double kGearForce = 2000;  // newtons that the gear between two jaws transmits: more than any load

// Of a solid cylinder of the capsule's full length about its middle: the caps' rounding is nothing beside the
// gears, which no model of the hand gives.
Matrix3d linkInertia(double mass_kg, const Vector3d& along, double radius) {
  const double length = along.norm() + 2 * radius;
  const double about = 0.5 * mass_kg * radius * radius;
  const double across = mass_kg * (length * length / 12 + radius * radius / 4);
  const Vector3d axis = along.normalized();
  return across * Matrix3d::Identity() + (about - across) * axis * axis.transpose();
}

double outerAngle(const HandDescription& hand, double inner) {
  return std::min(hand.coupling * inner, hand.outer_max);
}

}  // namespace

void DriveOptions::validate() const {
  requireOption(closing_rate_rad_s > 0, "closing_rate_rad_s", closing_rate_rad_s, "positive");
  requireOption(pressing_rate_rad_s > 0, "pressing_rate_rad_s", pressing_rate_rad_s, "positive");
  requireOption(touch_torque_nm > 0, "touch_torque_nm", touch_torque_nm, "positive");
  requireOption(breakaway_torque_nm > 0, "breakaway_torque_nm", breakaway_torque_nm, "positive");
  requireOption(load_limit_n > 0, "load_limit_n", load_limit_n, "positive");
  requireOption(stalled_share > 0 && stalled_share < 1, "stalled_share", stalled_share, "between 0 and 1");
  requireOption(stalled_time_s > 0, "stalled_time_s", stalled_time_s, "positive");
}

DrivenHand::DrivenHand(const HandDescription& hand, const HandJoints& joints, const Pose& X_WP,
                       const DriveOptions& options, PhysicsWorld& world)
    : hand_(hand),
      options_(options),
      world_(world),
      spread_(joints.spread),
      rate_(options.closing_rate_rad_s) {
  palm_ = world.addKinematicBody(X_WP);
  parts_.push_back({palmPart(hand), palm_});
  const HandGeometry geometry = forwardKinematics(hand, joints);
  if (hand.prismatic()) {
    addJaw({kF1, kF2}, joints, geometry, X_WP);
    addJaw({kThumb}, joints, geometry, X_WP);
  } else {
    for (int finger = 0; finger < 3; ++finger) addFinger(finger, joints, geometry, X_WP);
  }
}

void DrivenHand::addJaw(const std::vector<Finger>& on_it, const HandJoints& joints,
                        const HandGeometry& geometry, const Pose& X_WP) {
  const Finger first = on_it.front();
  const Pose X_PB = makePose(Matrix3d::Identity(), geometry.tips_P[first]);
  const BodyId body =
      world_.addBody(kJawMass, kJawMass * kJawLever * kJawLever * Matrix3d::Identity(), X_WP * X_PB);
  const Vector2d outwards = fingerDirection(first, joints.spread);
  const double start = joints.inner[first], slide = hand_.slide_per_rad;
  const JointId slider =
      world_.addSlider(palm_, body, X_WP.linear() * Vector3d(-outwards.x(), -outwards.y(), 0.0),
                       slide * (hand_.inner_min - start), slide * (hand_.inner_max - start));
  for (const Finger finger : on_it) {
    const Capsule* rail = &geometry.links[3 * finger];
    parts_.push_back({linkPart(*rail), palm_});
    for (const Capsule* link : {rail + 1, rail + 2})
      parts_.push_back({moved(linkPart(*link), X_PB.inverse()), body});
    fingers_[finger] = {.inner = body, .outer = body, .inner_hinge = slider, .inner_start = start};
  }
}

BodyId DrivenHand::addLink(const Capsule& link_P, double mass_kg, const Pose& X_WP) {
  const Pose X_PB = makePose(Matrix3d::Identity(), 0.5 * (link_P.a + link_P.b));
  const BodyId body =
      world_.addBody(mass_kg, linkInertia(mass_kg, link_P.b - link_P.a, link_P.radius), X_WP * X_PB);
  parts_.push_back({moved(linkPart(link_P), X_PB.inverse()), body});
  return body;
}

void DrivenHand::addFinger(int finger, const HandJoints& joints, const HandGeometry& geometry,
                           const Pose& X_WP) {
  const Capsule *knuckle = &geometry.links[3 * finger], *inner = knuckle + 1, *outer = knuckle + 2;
  const Vector2d u = fingerDirection(static_cast<Finger>(finger), joints.spread);
  const Vector3d axis_W = X_WP.linear() * Vector3d(u.y(), -u.x(), 0.0);  // turns u towards z
  DrivenFinger& driven = fingers_[finger];
  driven.inner_start = joints.inner[finger];
  driven.outer_start = outerAngle(hand_, driven.inner_start);
  parts_.push_back({linkPart(*knuckle), palm_});
  driven.inner = addLink(*inner, kInnerMass, X_WP);
  driven.outer = addLink(*outer, kOuterMass, X_WP);
  driven.inner_hinge =
      world_.addHinge(palm_, driven.inner, X_WP * inner->a, axis_W, hand_.inner_min - driven.inner_start,
                      hand_.inner_max - driven.inner_start);
  driven.outer_hinge = world_.addHinge(driven.inner, driven.outer, X_WP * outer->a, axis_W,
                                       -driven.outer_start, hand_.outer_max - driven.outer_start);
}

void DrivenHand::drive() {
  if (hand_.prismatic()) return driveJaws();
  for (DrivenFinger& finger : fingers_) {
    if (finger.paused) continue;
    follow(finger);
    driveFinger(finger);
  }
}

void DrivenHand::pause(std::size_t part) {
  if (parts_[part].body == palm_) return;
  if (hand_.prismatic()) {
    for (DrivenFinger& finger : fingers_) finger.paused = true;
    return;
  }
  DrivenFinger& finger = fingers_[parts_[part].part.finger];
  finger.paused = true;
  world_.drive(finger.inner_hinge, 0.0, options_.touch_torque_nm);
  world_.drive(finger.outer_hinge, 0.0, options_.touch_torque_nm);
}

void DrivenHand::resume() {
  rate_ = options_.pressing_rate_rad_s;
  for (DrivenFinger& finger : fingers_) finger.paused = false;
}

bool DrivenHand::waits() const {
  return std::all_of(fingers_.begin(), fingers_.end(), [](const DrivenFinger& finger) {
    return finger.paused || finger.state == DriveState::stalled;
  });
}

void DrivenHand::recall(const DriveMemory& memory) {
  fingers_ = memory.fingers;
  rate_ = memory.rate;
  load_n_ = memory.load_n;
  locked_ = memory.locked;
}

// The motor is at the jaw of F1 and F2; the gear brings the other to the same place.
void DrivenHand::driveJaws() {
  DrivenFinger& lead = fingers_[kF1];
  const double rate = lead.paused ? 0.0 : hand_.slide_per_rad * rate_, moving = world_.rate(lead.inner_hinge);
  const bool slow = moving < options_.stalled_share * rate;
  lead.slow_time_s = slow && !lead.paused ? lead.slow_time_s + world_.stepSize() : 0.0;
  if (lead.slow_time_s > options_.stalled_time_s) lead.state = DriveState::stalled;
  for (DrivenFinger& finger : fingers_) finger.state = lead.state;
  const JointId follower = fingers_[kThumb].inner_hinge;
  const double behind = world_.place(lead.inner_hinge) - world_.place(follower);
  world_.drive(lead.inner_hinge, rate, hand_.max_tip_force);
  world_.drive(follower, moving + kServoRate * behind, kGearForce);
}

void DrivenHand::follow(DrivenFinger& finger) {
  const bool closing = finger.state == DriveState::closing;
  const double rate = world_.rate(closing ? finger.inner_hinge : finger.outer_hinge);
  const bool slow = rate < options_.stalled_share * rate_;
  finger.slow_time_s = slow ? finger.slow_time_s + world_.stepSize() : 0.0;
  if (finger.slow_time_s <= options_.stalled_time_s) return;
  if (closing) {
    finger.state = DriveState::clutch_open;
    finger.lock_angle = world_.angle(finger.inner_hinge);
    finger.slow_time_s = 0.0;
  } else {
    finger.state = DriveState::stalled;
  }
}

void DrivenHand::driveFinger(DrivenFinger& finger) {
  const double tip = hand_.tip_length + hand_.tip_radius;
  const double outer_torque = options_.load_limit_n * tip;
  const double inner = world_.angle(finger.inner_hinge);
  if (finger.state == DriveState::closing) {
    const double target = outerAngle(hand_, inner + finger.inner_start) - finger.outer_start;
    world_.drive(finger.inner_hinge, rate_, options_.breakaway_torque_nm);
    world_.drive(finger.outer_hinge,
                 hand_.coupling * world_.rate(finger.inner_hinge) +
                     kServoRate * (target - world_.angle(finger.outer_hinge)),
                 outer_torque);
  } else {
    world_.drive(finger.inner_hinge, kServoRate * (finger.lock_angle - inner),
                 options_.load_limit_n * (hand_.inner_length + tip));
    const double eased =
        std::clamp(1.0 - load_n_ / (kPressed * hand_.max_tip_force), locked_ ? 0.0 : -1.0, 1.0);
    world_.drive(finger.outer_hinge, (1 + hand_.coupling) * eased * rate_, outer_torque);
  }
}

bool DrivenHand::stalled() const {
  return std::all_of(fingers_.begin(), fingers_.end(),
                     [](const DrivenFinger& finger) { return finger.state == DriveState::stalled; });
}

HandJoints DrivenHand::joints() const {
  HandJoints joints{spread_, {}};
  if (hand_.prismatic()) {
    for (int i = 0; i < 3; ++i)
      joints.inner[i] = fingers_[i].inner_start + world_.place(fingers_[i].inner_hinge) / hand_.slide_per_rad;
    return joints;
  }
  for (int i = 0; i < 3; ++i)
    joints.inner[i] = fingers_[i].inner_start + world_.angle(fingers_[i].inner_hinge);
  return joints;
}

std::array<double, 3> DrivenHand::outerJoints() const {
  std::array<double, 3> outer{};
  if (hand_.prismatic()) return outer;
  for (int i = 0; i < 3; ++i) outer[i] = fingers_[i].outer_start + world_.angle(fingers_[i].outer_hinge);
  return outer;
}

std::vector<PhysicalContact> DrivenHand::selfContacts() const {
  std::vector<PhysicalContact> contacts;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    for (std::size_t j = i + 1; j < parts_.size(); ++j) {
      const auto& [a, body_a] = parts_[i];
      const auto& [b, body_b] = parts_[j];
      if (a.finger == b.finger || body_a == body_b || body_a == palm_ || body_b == palm_) continue;
      const Pose X_WA = world_.pose(body_a), X_WB = world_.pose(body_b);
      const SegmentPair near = closestPoints(X_WA * a.centers_B.front(), X_WA * a.centers_B.back(),
                                             X_WB * b.centers_B.front(), X_WB * b.centers_B.back());
      const Vector3d apart = near.first - near.second;
      const double depth = a.radius + b.radius - apart.norm();
      if (depth <= 0 || apart.isZero()) continue;
      contacts.push_back({body_a, body_b, 0.5 * (near.first + near.second), apart.normalized(), depth, 0.0});
    }
  }
  return contacts;
}

}  // namespace boxgrasp
