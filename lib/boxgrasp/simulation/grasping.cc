#include "boxgrasp/simulation/grasping.h"

#include <algorithm>
#include <limits>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

constexpr double kFixed = std::numeric_limits<double>::infinity();  // newtons

void requireInput(const HandDescription& hand, const TrialInput& input) {
  const auto require = [](bool holds, std::string_view what) {
    if (!holds) throw InputError(fmt::format("trial: {}", what));
  };
  require(input.X_OP.matrix().allFinite(), "the palm's pose is not finite");
  require((input.X_OP.linear() * input.X_OP.linear().transpose()).isIdentity(1e-6) &&
              input.X_OP.linear().determinant() > 0,
          "the palm's pose is no rotation and translation");
  require(input.approach_m >= 0 && input.approach_m <= 10,
          fmt::format("approach_m is {}, but must be 0 to 10", input.approach_m));
  require(input.gravity_O.allFinite() && !input.gravity_O.isZero(), "gravity has no direction");
  for (const double inner : input.pregrasp.inner) {
    require(inner >= hand.inner_min && inner <= hand.inner_max,
            fmt::format("an inner joint is {} rad, outside the hand's limits {} to {}", inner, hand.inner_min,
                        hand.inner_max));
  }
  const double spread = input.pregrasp.spread;
  require(spread >= hand.spread_min && spread <= hand.spread_max,
          fmt::format("the spread is {} rad, outside the hand's limits {} to {}", spread, hand.spread_min,
                      hand.spread_max));
}

// The parts of the open hand, in P.
std::vector<HandPart> openHand(const HandDescription& hand, const HandJoints& joints) {
  std::vector<HandPart> parts{palmPart(hand)};
  for (const Capsule& link : forwardKinematics(hand, joints).links) parts.push_back(linkPart(link));
  return parts;
}

const HandPart* touching(const std::vector<HandPart>& parts, const Pose& X_OP, const DistanceField& field,
                         double depth_m) {
  for (const HandPart& part : parts) {
    for (const Touch& touch : touches(part, X_OP, field, 1)) {
      if (touch.depth > depth_m) return &part;
    }
  }
  return nullptr;
}

Pose backedUp(const Pose& X_OP, double by_m) { return X_OP * Eigen::Translation3d(0, 0, -by_m); }

}  // namespace

Grasping::Grasping(const HandDescription& hand, const SimulatedObject& object, const TrialInput& input,
                   const TrialOptions& options, const StopToken& stop, const TrialObserver& observer)
    : hand_(hand), object_(object), input_(input), options_(options), stop_(stop), observer_(observer) {
  options.validate();
  requireInput(hand, input);
  stop.check();
}

bool Grasping::grasp() { return approach() && close() && letGo(); }

bool Grasping::ends(TrialOutcome outcome) {
  result_.outcome = outcome;
  return false;
}

void Grasping::step(const Pose& X_WP, const Vector3d& force_W) {
  stop_.check();
  scene_->step(X_WP, force_W);
  ++result_.steps;
  const auto every = std::max(1L, std::lround(observer_.every_s / scene_->stepSize()));
  if (observer_.see && result_.steps % every == 0) showScene();
}

void Grasping::showApproach(const Pose& X_OP) const {
  TrialMoment moment;
  moment.X_WP = X_OP;
  moment.joints = input_.pregrasp;
  for (const Capsule& link : forwardKinematics(hand_, input_.pregrasp).links) {
    moment.links_W.push_back({link.name, link.finger, X_OP * link.a, X_OP * link.b, link.radius});
  }
  observer_.see(moment);
}

void Grasping::showScene() const {
  const DrivenHand& hand = scene_->hand();
  TrialMoment moment{phase_,
                     static_cast<double>(result_.steps) * options_.physics.step_s,
                     scene_->palmPose(),
                     scene_->palmPose() * scene_->objectInPalm() * Eigen::Translation3d(-object_.center_O),
                     hand.joints(),
                     hand.outerJoints(),
                     {},
                     pressing()};
  for (const auto& [part, body] : hand.parts()) {
    if (part.finger < 0) continue;
    const Pose X_WB = scene_->world().pose(body);
    moment.links_W.push_back(
        {part.name, part.finger, X_WB * part.centers_B.front(), X_WB * part.centers_B.back(), part.radius});
  }
  observer_.see(moment);
}

double Grasping::slip() const {
  return (scene_->objectInPalm().translation() - X_PG_mark_.translation()).norm();
}

double Grasping::rotation() const {
  const Matrix3d R = scene_->objectInPalm().linear() * X_PG_mark_.linear().transpose();
  return Eigen::AngleAxisd(R).angle();
}

double Grasping::mass() const { return options_.physics.mass_factor * object_.mass_kg; }

Vector3d Grasping::weight_W() const { return options_.gravity_m_s2 * mass() * input_.gravity_O.normalized(); }

void Grasping::restore(const State& state) {
  scene_->restore(state.scene);
  X_WP_ = state.X_WP;
  X_PG_mark_ = state.X_PG_mark;
}

bool Grasping::approach() {
  const std::vector<HandPart> parts = openHand(hand_, input_.pregrasp);
  const int steps = static_cast<int>(std::ceil(input_.approach_m / options_.sweep_step_m));
  for (int i = 0; i <= steps; ++i) {
    stop_.check();
    const double left_m = input_.approach_m * (steps - i) / std::max(1, steps);
    if (observer_.see) showApproach(backedUp(input_.X_OP, left_m));
    const HandPart* part =
        touching(parts, backedUp(input_.X_OP, left_m), object_.field, options_.touch_depth_m);
    if (!part) continue;
    result_.touched = part->name;
    result_.stopped_short_m = left_m;
    if (options_.back_up_on_touch)
      result_.stopped_short_m += options_.back_up_m;
    else if (left_m > options_.touch_short_m)
      return ends(TrialOutcome::collided);
    break;
  }
  X_WP_ = backedUp(input_.X_OP, result_.stopped_short_m);
  return true;
}

bool Grasping::rest(double time_s, const Vector3d& force_W) {
  for (double t = 0; t < time_s; t += scene_->stepSize()) {
    step(X_WP_, force_W);
    if (lost()) return false;
  }
  return true;
}

bool Grasping::settle() {
  for (double t = 0; t < options_.settle_limit_s; t += options_.settle_time_s) {
    const Vector3d before = scene_->objectInPalm().translation();
    if (!rest(options_.settle_time_s, Vector3d::Zero())) return false;
    if ((scene_->objectInPalm().translation() - before).norm() < options_.still_m) break;
  }
  return true;
}

// Closes each finger until it touches the object, which stays where it is.
void Grasping::touch() {
  phase_ = TrialPhase::touch;
  DrivenHand& hand = scene_->hand();
  scene_->world().hold(scene_->object(), kFixed, kFixed);
  for (double t = 0; t < options_.close_time_s && !hand.waits(); t += scene_->stepSize()) {
    step(X_WP_, Vector3d::Zero());
    for (const SceneContact& contact : scene_->contacts()) hand.pause(contact.part);
  }
  mark();
  scene_->world().release();
  hand.resume();
}

bool Grasping::close() {
  scene_.emplace(hand_, input_.pregrasp, X_WP_, object_, options_.physics);
  touch();
  phase_ = TrialPhase::press;
  const double force = options_.support_friction * weight_W().norm();
  scene_->world().hold(scene_->object(), force, force * object_.largest_distance_m);
  for (double t = 0; t < options_.close_time_s && !scene_->hand().stalled(); t += scene_->stepSize()) {
    step(X_WP_, Vector3d::Zero());
  }
  const bool stays = settle();
  readHand();
  if (!stays) return ends(TrialOutcome::unstable);
  return !result_.contacts.empty() || ends(TrialOutcome::missed);
}

void Grasping::readHand() {
  result_.joints = scene_->hand().joints();
  result_.outer = scene_->hand().outerJoints();
  result_.stalled = scene_->hand().stalled();
  result_.contacts = pressing();
  mark();
}

std::vector<TrialContact> Grasping::pressing() const {
  std::vector<TrialContact> contacts;
  for (const SceneContact& contact : scene_->contacts()) {
    const HandPart& part = scene_->hand().parts()[contact.part].part;
    if (!(contact.force_O.dot(contact.touch.normal_O) > 0)) continue;
    contacts.push_back({part.name, part.finger, contact.touch.p_O, contact.touch.normal_O, contact.force_O});
  }
  return contacts;
}

bool Grasping::letGo() {
  phase_ = TrialPhase::settle;
  scene_->world().release();
  const bool stays = settle() && !scene_->contacts().empty();
  if (stays) readHand();
  scene_->hand().lock();
  result_.quality = qualityOf(result_.contacts);
  return stays || ends(TrialOutcome::unstable);
}

GraspQuality Grasping::qualityOf(const std::vector<TrialContact>& touches) const {
  std::vector<Contact> contacts;
  for (const TrialContact& touch : touches) contacts.push_back({touch.p_O, touch.normal_O});
  return graspQuality(contacts, {.friction = options_.physics.friction,
                                 .cone_edges = options_.cone_edges,
                                 .norm = options_.norm,
                                 .p_CG = object_.center_O,
                                 .torque_scale_m = object_.largest_distance_m});
}

bool Grasping::carry(const PalmMotion& motion) {
  const Pose X_WP_start = X_WP_;
  for (double t = scene_->stepSize(); t < motion.time_s; t += scene_->stepSize()) {
    step(X_WP_ = motion.pose(X_WP_start, t), weight_W());
    if (lost()) return false;
  }
  X_WP_ = motion.pose(X_WP_start, motion.time_s);
  return true;
}

}  // namespace boxgrasp
