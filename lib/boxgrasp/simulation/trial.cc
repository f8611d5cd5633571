#include "boxgrasp/simulation/trial.h"

#include "boxgrasp/base/error.h"
#include "boxgrasp/simulation/grasping.h"
#include "boxgrasp/simulation/motions.h"

namespace boxgrasp {
namespace {

bool lift(Grasping& grasping, const TrialInput& input, const TrialOptions& options) {
  grasping.enter(TrialPhase::lift);
  const PalmMotion rise =
      liftMotion(-input.gravity_O.normalized(), options.lift_height_m, options.lift_acceleration_m_s2);
  const bool held = grasping.carry(rise) && grasping.rest(options.wait_time_s, grasping.weight_W());
  grasping.result().lift_slip_m = grasping.slip();
  grasping.result().lift_rotation_rad = grasping.rotation();
  return held || grasping.ends(TrialOutcome::lost_in_lift);
}

bool shake(Grasping& grasping, const TrialOptions& options) {
  grasping.enter(TrialPhase::shake);
  grasping.mark();
  const Shake how{options.shake_frequency_hz, options.shake_periods};
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d unit_P = Vector3d::Unit(axis);
    const bool held = grasping.carry(shakeAlong(unit_P, options.shake_amplitude_m, how)) &&
                      grasping.carry(shakeAbout(unit_P, options.shake_angle_rad, how));
    if (!held) return grasping.ends(TrialOutcome::lost_in_shake);
  }
  return true;
}

// The force, up to the limit, under which the object slips.
double forceHeld(const Vector3d& direction_W, double limit_n, Grasping& grasping,
                 const TrialOptions& options) {
  double force = 0.0;
  while (force < limit_n && !grasping.movedBeyond(options.push_slip_m)) {
    grasping.step(grasping.weight_W() + force * direction_W);
    force += options.push_rate_n_s * options.physics.step_s;
  }
  return std::min(force, limit_n);
}

void push(Grasping& grasping, const TrialOptions& options) {
  grasping.enter(TrialPhase::push);
  grasping.mark();
  const Grasping::State shaken = grasping.state();
  const Matrix3d R_WP = grasping.palm().linear();
  double least = options.push_limit_n;
  for (const int axis : {2, 1, 0}) {
    for (const double sign : {1.0, -1.0}) {
      grasping.restore(shaken);
      least = forceHeld(sign * R_WP.col(axis), least, grasping, options);
    }
  }
  grasping.result().push_force_n = least;
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

void runStages(Grasping& grasping, const TrialInput& input, const TrialOptions& options) {
  const TrialStage last = options.last_stage;
  const bool lifted = grasping.grasp() && (last < TrialStage::lift || lift(grasping, input, options));
  const bool shaken = lifted && (last < TrialStage::shake || shake(grasping, options));
  if (shaken) grasping.ends(TrialOutcome::held);
  if (shaken && last >= TrialStage::push) push(grasping, options);
}

}  // namespace

void PhysicsOptions::validate() const {
  requireOption(step_s > 0 && step_s <= 0.01, "step_s", step_s, "positive and at most 0.01");
  requireOption(friction >= 0, "friction", friction, "at least 0");
  requireOption(mass_factor > 0, "mass_factor", mass_factor, "positive");
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
  positive("slip_limit_m", slip_limit_m);
  positive("lift_acceleration_m_s2", lift_acceleration_m_s2);
  positive("shake_frequency_hz", shake_frequency_hz);
  positive("push_rate_n_s", push_rate_n_s);
  positive("push_slip_m", push_slip_m);
  notNegative("gravity_m_s2", gravity_m_s2);
  notNegative("touch_depth_m", touch_depth_m);
  notNegative("back_up_m", back_up_m);
  notNegative("touch_short_m", touch_short_m);
  notNegative("support_friction", support_friction);
  positive("settle_time_s", settle_time_s);
  positive("still_m", still_m);
  positive("settle_limit_s", settle_limit_s);
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
  Grasping grasping(hand, object, input, options, stop, observer);
  TrialResult& result = grasping.result();
  try {
    runStages(grasping, input, options);
  } catch (const PhysicsFailure&) {
    result.outcome = TrialOutcome::unstable;
    result.physics_failed = true;
  }
  result.simulated_s = static_cast<double>(result.steps) * options.physics.step_s;
  result.report = reportOf(result);
  return std::move(result);
}

}  // namespace boxgrasp
