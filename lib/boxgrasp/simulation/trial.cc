#include "boxgrasp/simulation/trial.h"

#include <algorithm>
#include <numbers>
#include <optional>

#include "boxgrasp/base/error.h"
#include "boxgrasp/simulation/motions.h"

namespace boxgrasp {
namespace {

constexpr double kFixed = 1e6;  // newtons: more than anything here can press

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

// One trial as it runs. Stages return false where they ended the trial.
class Trial {
 public:
  Trial(const HandDescription& hand, const SimulatedObject& object, const TrialInput& input,
        const TrialOptions& options, const StopToken& stop, const TrialObserver& observer)
      : hand_(hand), object_(object), input_(input), options_(options), stop_(stop), observer_(observer) {}

  TrialResult run();

 private:
  void runStages();
  bool approach();
  void touch();
  bool close();
  bool letGo();
  bool lift();
  bool shake();
  void push();

  void readHand();
  std::vector<TrialContact> pressing() const;
  void showApproach(const Pose& X_OP) const;
  void showScene() const;
  GraspQuality qualityOf(const std::vector<TrialContact>& touches) const;
  void step(const Pose& X_WP, const Vector3d& force_W);
  bool rest(double time_s, const Vector3d& force_W);
  bool carry(const PalmMotion& motion, double limit_m);
  bool ends(TrialOutcome outcome);
  bool movedBeyond(double limit_m) const;
  Vector3d weight_W() const {
    return options_.gravity_m_s2 * object_.mass_kg * input_.gravity_O.normalized();
  }

  const HandDescription& hand_;
  const SimulatedObject& object_;
  const TrialInput& input_;
  const TrialOptions& options_;
  const StopToken& stop_;
  const TrialObserver& observer_;
  TrialPhase phase_ = TrialPhase::approach;
  TrialResult result_;
  std::optional<GraspScene> scene_;
  Pose X_WP_;        // where the palm is to stay
  Pose X_PG_grasp_;  // of the object in the palm when it was grasped
};

bool Trial::ends(TrialOutcome outcome) {
  result_.outcome = outcome;
  return false;
}

void Trial::step(const Pose& X_WP, const Vector3d& force_W) {
  stop_.check();
  scene_->step(X_WP, force_W);
  ++result_.steps;
  const auto every = std::max(1L, std::lround(observer_.every_s / scene_->stepSize()));
  if (observer_.see && result_.steps % every == 0) showScene();
}

void Trial::showApproach(const Pose& X_OP) const {
  TrialMoment moment;
  moment.X_WP = X_OP;
  moment.joints = input_.pregrasp;
  for (const Capsule& link : forwardKinematics(hand_, input_.pregrasp).links) {
    moment.links_W.push_back({link.name, link.finger, X_OP * link.a, X_OP * link.b, link.radius});
  }
  observer_.see(moment);
}

void Trial::showScene() const {
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

// Not a number counts as moved: whatever the physics could not solve is not held.
bool Trial::movedBeyond(double limit_m) const {
  const Vector3d slip = scene_->objectInPalm().translation() - X_PG_grasp_.translation();
  return !(slip.norm() <= limit_m);
}

bool Trial::approach() {
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
    if (!options_.back_up_on_touch) return ends(TrialOutcome::collided);
    result_.stopped_short_m += options_.back_up_m;
    break;
  }
  X_WP_ = backedUp(input_.X_OP, result_.stopped_short_m);
  return true;
}

bool Trial::rest(double time_s, const Vector3d& force_W) {
  for (double t = 0; t < time_s; t += scene_->stepSize()) {
    step(X_WP_, force_W);
    if (movedBeyond(options_.lost_m)) return false;
  }
  return true;
}

// Closes each finger until it touches the object, which stays where it is.
void Trial::touch() {
  phase_ = TrialPhase::touch;
  DrivenHand& hand = scene_->hand();
  scene_->world().hold(scene_->object(), kFixed, kFixed);
  for (double t = 0; t < options_.close_time_s && !hand.waits(); t += scene_->stepSize()) {
    step(X_WP_, Vector3d::Zero());
    for (const SceneContact& contact : scene_->contacts()) hand.pause(contact.part);
  }
  X_PG_grasp_ = scene_->objectInPalm();
  scene_->world().release();
  hand.resume();
}

bool Trial::close() {
  scene_.emplace(hand_, input_.pregrasp, X_WP_, object_, options_.physics);
  touch();
  phase_ = TrialPhase::press;
  const double force = options_.support_friction * weight_W().norm();
  scene_->world().hold(scene_->object(), force, force * object_.largest_distance_m);
  for (double t = 0; t < options_.close_time_s && !scene_->hand().stalled(); t += scene_->stepSize()) {
    step(X_WP_, Vector3d::Zero());
  }
  const bool stays = rest(options_.settle_time_s, Vector3d::Zero());
  readHand();
  if (!result_.contacts.empty()) return stays || ends(TrialOutcome::unstable);
  return ends(TrialOutcome::missed);
}

void Trial::readHand() {
  result_.joints = scene_->hand().joints();
  result_.outer = scene_->hand().outerJoints();
  result_.stalled = scene_->hand().stalled();
  result_.contacts = pressing();
  X_PG_grasp_ = scene_->objectInPalm();
}

std::vector<TrialContact> Trial::pressing() const {
  std::vector<TrialContact> contacts;
  for (const SceneContact& contact : scene_->contacts()) {
    const HandPart& part = scene_->hand().parts()[contact.part].part;
    if (!(contact.force_O.dot(contact.touch.normal_O) > 0)) continue;
    contacts.push_back({part.name, part.finger, contact.touch.p_O, contact.touch.normal_O, contact.force_O});
  }
  return contacts;
}

bool Trial::letGo() {
  phase_ = TrialPhase::settle;
  scene_->world().release();
  const bool stays = rest(options_.settle_time_s, Vector3d::Zero()) && !scene_->contacts().empty();
  if (stays) readHand();
  result_.quality = qualityOf(result_.contacts);
  return stays || ends(TrialOutcome::unstable);
}

GraspQuality Trial::qualityOf(const std::vector<TrialContact>& touches) const {
  std::vector<Contact> contacts;
  for (const TrialContact& touch : touches) contacts.push_back({touch.p_O, touch.normal_O});
  return graspQuality(contacts, {.friction = options_.physics.friction,
                                 .cone_edges = options_.cone_edges,
                                 .norm = options_.norm,
                                 .p_CG = object_.center_O,
                                 .torque_scale_m = object_.largest_distance_m});
}

// Moves the palm as the motion says, starting from where it is to stay, which then is where the motion ended.
bool Trial::carry(const PalmMotion& motion, double limit_m) {
  const Pose X_WP_start = X_WP_;
  for (double t = scene_->stepSize(); t < motion.time_s; t += scene_->stepSize()) {
    step(X_WP_ = motion.pose(X_WP_start, t), weight_W());
    if (movedBeyond(limit_m)) return false;
  }
  X_WP_ = motion.pose(X_WP_start, motion.time_s);
  return true;
}

bool Trial::lift() {
  phase_ = TrialPhase::lift;
  const Vector3d up_W = -input_.gravity_O.normalized();
  const PalmMotion rise = liftMotion(up_W, options_.lift_height_m, options_.lift_acceleration_m_s2);
  const bool held = carry(rise, options_.lost_m) && rest(options_.wait_time_s, weight_W());
  const Pose X_PG = scene_->objectInPalm();
  result_.lift_slip_m = (X_PG.translation() - X_PG_grasp_.translation()).norm();
  result_.lift_rotation_rad =
      Eigen::AngleAxisd(Matrix3d(X_PG.linear() * X_PG_grasp_.linear().transpose())).angle();
  return held || ends(TrialOutcome::lost_in_lift);
}

bool Trial::shake() {
  phase_ = TrialPhase::shake;
  for (int axis = 0; axis < 3; ++axis) {
    const Shake shake{options_.shake_frequency_hz, options_.shake_periods};
    const Vector3d unit_P = Vector3d::Unit(axis);
    const bool held = carry(shakeAlong(unit_P, options_.shake_amplitude_m, shake), options_.lost_m) &&
                      carry(shakeAbout(unit_P, options_.shake_angle_rad, shake), options_.lost_m);
    if (!held) return ends(TrialOutcome::lost_in_shake);
  }
  return true;
}

void Trial::push() {
  phase_ = TrialPhase::push;
  X_PG_grasp_ = scene_->objectInPalm();
  const Vector3d away_W = X_WP_.linear().col(2);
  double force = 0.0;
  while (force < options_.push_limit_n && !movedBeyond(options_.push_slip_m)) {
    step(X_WP_, weight_W() + force * away_W);
    force += options_.push_rate_n_s * scene_->stepSize();
  }
  result_.push_force_n = std::min(force, options_.push_limit_n);
}

std::string reportOf(const TrialResult& result) {
  std::string text = fmt::format("{}: {} contacts", describe(result.outcome), result.contacts.size());
  if (!result.touched.empty()) {
    text += fmt::format(", {} touched {:.0f} mm short", result.touched, 1e3 * result.stopped_short_m);
  }
  if (!result.contacts.empty()) text += fmt::format(", epsilon {:.4f}", result.quality.epsilon);
  if (!std::isnan(result.lift_slip_m)) {
    text += fmt::format(", slipped {:.1f} mm and turned {:.1f} deg in the lift", 1e3 * result.lift_slip_m,
                        result.lift_rotation_rad * 180 / std::numbers::pi);
  }
  if (!std::isnan(result.push_force_n)) text += fmt::format(", held {:.1f} N", result.push_force_n);
  if (result.physics_failed) text += ", where the physics engine gave up";
  return text + fmt::format("; {} steps", result.steps);
}

void Trial::runStages() {
  const TrialStage last = options_.last_stage;
  const bool grasped = approach() && close() && letGo();
  const bool lifted = grasped && (last < TrialStage::lift || lift());
  const bool shaken = lifted && (last < TrialStage::shake || shake());
  if (shaken) result_.outcome = TrialOutcome::held;
  if (shaken && last >= TrialStage::push) push();
}

TrialResult Trial::run() {
  try {
    runStages();
  } catch (const PhysicsFailure&) {
    result_.outcome = TrialOutcome::unstable;
    result_.physics_failed = true;
  }
  result_.simulated_s = static_cast<double>(result_.steps) * options_.physics.step_s;
  result_.report = reportOf(result_);
  return std::move(result_);
}

}  // namespace

void PhysicsOptions::validate() const {
  requireOption(step_s > 0 && step_s <= 0.01, "step_s", step_s, "positive and at most 0.01");
  requireOption(friction >= 0, "friction", friction, "at least 0");
  requireOption(material.stiffness > 0, "stiffness", material.stiffness, "positive");
  requireOption(material.damping >= 0, "damping", material.damping, "at least 0");
  drive.validate();
}

void TrialOptions::validate() const {
  physics.validate();
  const auto positive = [](std::string_view field, double value) {
    requireOption(value > 0 && std::isfinite(value), field, value, "positive");
  };
  const auto notNegative = [](std::string_view field, double value) {
    requireOption(value >= 0 && std::isfinite(value), field, value, "at least 0");
  };
  positive("sweep_step_m", sweep_step_m);
  positive("close_time_s", close_time_s);
  positive("lost_m", lost_m);
  positive("lift_acceleration_m_s2", lift_acceleration_m_s2);
  positive("shake_frequency_hz", shake_frequency_hz);
  positive("push_rate_n_s", push_rate_n_s);
  positive("push_slip_m", push_slip_m);
  notNegative("gravity_m_s2", gravity_m_s2);
  notNegative("touch_depth_m", touch_depth_m);
  notNegative("back_up_m", back_up_m);
  notNegative("support_friction", support_friction);
  notNegative("settle_time_s", settle_time_s);
  notNegative("lift_height_m", lift_height_m);
  notNegative("wait_time_s", wait_time_s);
  notNegative("push_limit_n", push_limit_n);
  requireOption(shake_periods >= 0, "shake_periods", shake_periods, "at least 0");
  requireOption(cone_edges >= 3 && cone_edges <= 64, "cone_edges", cone_edges, "3 to 64");
}

std::string_view describe(TrialOutcome outcome) {
  switch (outcome) {
    case TrialOutcome::missed:
      return "missed";
    case TrialOutcome::collided:
      return "collided";
    case TrialOutcome::unstable:
      return "unstable";
    case TrialOutcome::lost_in_lift:
      return "lost in lift";
    case TrialOutcome::lost_in_shake:
      return "lost in shake";
    case TrialOutcome::held:
      break;
  }
  return "held";
}

std::string_view describe(TrialPhase phase) {
  constexpr std::array<std::string_view, 7> kNames{"approach", "touch", "press", "let go",
                                                   "lift",     "shake", "push"};
  return kNames[static_cast<std::size_t>(phase)];
}

TrialResult runTrial(const HandDescription& hand, const SimulatedObject& object, const TrialInput& input,
                     const TrialOptions& options, const StopToken& stop, const TrialObserver& observer) {
  options.validate();
  requireInput(hand, input);
  stop.check();
  return Trial(hand, object, input, options, stop, observer).run();
}

}  // namespace boxgrasp
