// Published tests of grasps, so that grasps of this hand can be compared with those of learnt planners
// (definitions, 8). The hand is the real one all the same: coupled joints, clutches, four motors, at most
// max_tip_force at a fingertip; and it has to get to the object first.
#pragma once

#include "boxgrasp/simulation/trial.h"

namespace boxgrasp {

// D(R,O): without gravity the closed hand holds the object while it is pushed along +x, +y, +z, -x, -y, -z of
// O, one after the other.
struct SixPushOptions {
  double friction =
      3.0;  // as published, like all of these: lenient, the force being a twentieth of the weight
  double density_kg_m3 = 500.0;
  double acceleration_m_s2 = 0.5;  // force over mass
  double push_time_s = 1.0;        // in each direction
  double displacement_m = 0.02;    // held: the object ends at most so far from where it was
  void validate() const;
};

struct SixPushResult {
  TrialOutcome outcome = TrialOutcome::missed;  // held; or why there was nothing to push; lost is `unstable`
  double displacement_m = NAN;  // of the centre of mass from the closed hand's grasp to the end of all six
                                // pushes; NaN: nothing was held to begin with
  bool held() const { return outcome == TrialOutcome::held; }
};

// Approach, pregrasp, closing and physics are those of a trial with these input and options, but for the
// friction and the density, with which the hand closes anew: other friction closes otherwise. Throws as
// runTrial().
SixPushResult pushSixWays(const HandDescription& hand, const SimulatedObject& object, const TrialInput& input,
                          const TrialOptions& options = {}, const SixPushOptions& pushes = {},
                          const StopToken& stop = {});

// DexGraspNet: gravity acts along each axis of O, both ways, each time from the same closed hand.
struct SixGravityOptions {
  double friction = 0.5;  // published with 3; 0.5 is what a hand of metal has on most things
  double density_kg_m3 = 500.0;
  double gravity_m_s2 = 9.81;
  double time_s = 100.0 / 60.0;  // of gravity in each direction
  void validate() const;
};

struct SixGravityResult {
  TrialOutcome outcome = TrialOutcome::missed;  // held: in all directions; or how the closing ended
  int directions_held = 0;                      // in which hand and object still touch when the time is over
};

// As pushSixWays(). The hand closes once; the directions start from copies of that state.
SixGravityResult holdInSixGravities(const HandDescription& hand, const SimulatedObject& object,
                                    const TrialInput& input, const TrialOptions& options = {},
                                    const SixGravityOptions& gravities = {}, const StopToken& stop = {});

}  // namespace boxgrasp
