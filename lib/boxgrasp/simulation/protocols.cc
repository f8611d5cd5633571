#include "boxgrasp/simulation/protocols.h"

#include "boxgrasp/base/error.h"
#include "boxgrasp/simulation/grasping.h"

namespace boxgrasp {
namespace {

// In the order of D(R,O): positive axes first.
Vector3d direction(int which) { return (which < 3 ? 1.0 : -1.0) * Vector3d::Unit(which % 3); }

TrialOptions withSurface(TrialOptions options, const SimulatedObject& object, double friction,
                         double density_kg_m3) {
  options.physics.friction = friction;
  options.physics.mass_factor = density_kg_m3 / object.density_kg_m3;
  return options;
}

// One test that starts from a closed hand. Steps that the engine cannot solve hold nothing.
template <typename Test>
TrialOutcome afterGrasping(Grasping& grasping, const Test& test) {
  try {
    if (!grasping.grasp()) return grasping.result().outcome;
    return test() ? TrialOutcome::held : TrialOutcome::unstable;
  } catch (const PhysicsFailure&) {
    return TrialOutcome::unstable;
  }
}

// Whatever happens meanwhile: the protocols judge at the end.
void waitUnder(const Vector3d& force_W, double time_s, Grasping& grasping) {
  const double step_s = grasping.scene().stepSize();
  for (double t = 0; t < time_s; t += step_s) grasping.step(force_W);
}

}  // namespace

void SixPushOptions::validate() const {
  requireOption(friction >= 0, "friction", friction, "at least 0");
  requireOption(density_kg_m3 > 0, "density_kg_m3", density_kg_m3, "positive");
  requireOption(acceleration_m_s2 >= 0, "acceleration_m_s2", acceleration_m_s2, "at least 0");
  requireOption(push_time_s > 0, "push_time_s", push_time_s, "positive");
  requireOption(displacement_m > 0, "displacement_m", displacement_m, "positive");
}

void SixGravityOptions::validate() const {
  requireOption(friction >= 0, "friction", friction, "at least 0");
  requireOption(density_kg_m3 > 0, "density_kg_m3", density_kg_m3, "positive");
  requireOption(gravity_m_s2 >= 0, "gravity_m_s2", gravity_m_s2, "at least 0");
  requireOption(time_s > 0, "time_s", time_s, "positive");
}

SixPushResult pushSixWays(const HandDescription& hand, const SimulatedObject& object, const TrialInput& input,
                          const TrialOptions& options, const SixPushOptions& pushes, const StopToken& stop) {
  pushes.validate();
  const TrialOptions as_published = withSurface(options, object, pushes.friction, pushes.density_kg_m3);
  Grasping grasping(hand, object, input, as_published, stop);
  SixPushResult result;
  result.outcome = afterGrasping(grasping, [&] {
    const double force = grasping.mass() * pushes.acceleration_m_s2;
    for (int i = 0; i < 6; ++i) waitUnder(force * direction(i), pushes.push_time_s, grasping);
    result.displacement_m = grasping.slip();
    return result.displacement_m <= pushes.displacement_m;
  });
  return result;
}

SixGravityResult holdInSixGravities(const HandDescription& hand, const SimulatedObject& object,
                                    const TrialInput& input, const TrialOptions& options,
                                    const SixGravityOptions& gravities, const StopToken& stop) {
  gravities.validate();
  const TrialOptions with_surface = withSurface(options, object, gravities.friction, gravities.density_kg_m3);
  Grasping grasping(hand, object, input, with_surface, stop);
  SixGravityResult result;
  result.outcome = afterGrasping(grasping, [&] {
    const Grasping::State closed = grasping.state();
    const double weight = grasping.mass() * gravities.gravity_m_s2;
    for (int i = 0; i < 6; ++i) {
      grasping.restore(closed);
      waitUnder(weight * direction(i), gravities.time_s, grasping);
      if (!grasping.scene().contacts().empty()) ++result.directions_held;
    }
    return result.directions_held == 6;
  });
  return result;
}

}  // namespace boxgrasp
