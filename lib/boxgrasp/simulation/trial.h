// One grasp tried out: the hand comes, closes, lifts, shakes, and is pulled at.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/simulation/scene.h"
#include "boxgrasp/wrench/grasp_wrench_space.h"

namespace boxgrasp {

enum class TrialStage { close, lift, shake, push };

struct TrialOptions {
  PhysicsOptions physics;
  TrialStage last_stage =
      TrialStage::push;  // earlier: only the labels up to there, in a fraction of the time
  double gravity_m_s2 = 9.81;

  // On the way in, with the object fixed.
  double sweep_step_m = 0.002;   // poses tested along the way; less than any part of the hand is thick
  double touch_depth_m = 0.001;  // a link this deep in the object has touched it; less is grazing
  bool back_up_on_touch =
      false;  // a hand that touches backs up and closes there, as approach-and-close planners
              // do (paper, ref. 11); otherwise it has collided and the trial is over
  double back_up_m = 0.010;
  double touch_short_m = 0.010;  // with no more than this left to go, the hand stops at the touch and closes

  // Closing, without gravity. First each finger closes until it touches the object, which is fixed meanwhile
  // as in the paper's simulator; then all press together, and the object gives way as if it stood on a table
  // of this friction.
  double support_friction = 0.5;
  double close_time_s = 3.0;  // fingers that have not stalled by then never will
  // Of the closed hand, and again once the support is gone: until the object moves less than this in one such
  // time, so that what leaves the hand slowly has left it before the lift.
  double settle_time_s = 0.1;
  double still_m = 0.0005;
  double settle_limit_s = 1.0;

  WrenchNorm norm = WrenchNorm::l1;  // of epsilon and nu
  int cone_edges = 8;

  // Lost: the centre of mass has moved this far in the palm's frame. While the hand closes it may draw the
  // object in; a closed hand in which it slips farther than this has no sure hold of it.
  double lost_m = 0.05;
  double slip_limit_m = 0.025;  // in lift and shake, each from its beginning
  double lift_height_m = 0.2;
  double lift_acceleration_m_s2 = 0.5;
  double wait_time_s = 0.3;
  double shake_amplitude_m = 0.05;  // along each axis of P
  double shake_frequency_hz = 2.0;
  int shake_periods = 1;                          // along and about each axis
  double shake_angle_rad = std::numbers::pi / 6;  // about each axis through the palm's origin
  double push_rate_n_s = 20.0;  // under the object's weight, along both ways of each axis of P in turn
  double push_slip_m = 0.02;    // slipped this far, the object is lost
  double push_limit_n = 60.0;   // an object that holds this is held; no more is asked

  void validate() const;
};

struct TrialInput {
  Pose X_OP = Pose::Identity();             // the palm at the end of the approach, in the object's frame
  HandJoints pregrasp;                      // spread and opened fingers
  double approach_m = 0.15;                 // length of the straight way in, along z of P
  Vector3d gravity_O = -Vector3d::UnitZ();  // direction, any length
};

enum class TrialOutcome {
  missed,    // the hand closed, and nothing in it
  collided,  // the open hand met the object on its way
  unstable,  // the object was squeezed out of the closing hand, or left it when the support did
  lost_in_lift,
  lost_in_shake,
  held,  // came through all the stages asked for
};
std::string_view describe(TrialOutcome outcome);

struct TrialContact {
  std::string_view link;
  int finger = -1;                       // -1: the palm
  Vector3d p_O = Vector3d::Zero();       // metres
  Vector3d normal_O = Vector3d::Zero();  // unit, into the object
  Vector3d force_O = Vector3d::Zero();   // on the object, newtons
};

// What has not been reached stays NaN, or empty.
struct TrialResult {
  TrialOutcome outcome = TrialOutcome::missed;
  double stopped_short_m = 0.0;  // of the pose asked for, by a touch on the way and the backing up from it
  std::string_view touched;      // the part that touched on the way; empty: none
  std::vector<TrialContact> contacts;  // of the closed hand, once the support is gone; unstable: before
  HandJoints joints;                   // reached in closing
  std::array<double, 3> outer{NAN, NAN, NAN};  // outer joints, which the clutch frees from the inner ones
  bool stalled = false;                        // every finger, in time
  GraspQuality
      quality;  // of the contacts, torques about the centre of mass over its largest distance to the surface
  double lift_slip_m = NAN;        // of the centre of mass in the palm's frame
  double lift_rotation_rad = NAN;  // of the object in the palm's frame
  double push_force_n =
      NAN;  // at the centre of mass, before it slipped; in the weakest of the six directions
  double simulated_s = 0.0;
  std::size_t steps = 0;
  bool physics_failed = false;  // a step could not be solved; counts as unstable
  std::string report;           // one sentence
};

enum class TrialPhase { approach, touch, press, settle, lift, shake, push };  // in the order of time
std::string_view describe(TrialPhase phase);

// A trial at one moment, in the world W: the object's frame as it was at the start.
struct TrialMoment {
  TrialPhase phase = TrialPhase::approach;
  double time_s = 0.0;  // simulated; 0 on the way in
  Pose X_WP = Pose::Identity(), X_WO = Pose::Identity();
  HandJoints joints;
  std::array<double, 3> outer{NAN, NAN, NAN};  // outer joints; NaN on the way in, where they follow the inner
  std::vector<Capsule> links_W;                // as the physics has them
  std::vector<TrialContact> contacts;          // those that press
};

// Looks on, without changing what happens.
struct TrialObserver {
  double every_s = 0.01;                        // of simulated time; on the way in, at every pose tested
  std::function<void(const TrialMoment&)> see;  // empty: nobody looks on
};

// The same input gives the same result to the bit, on any thread. Throws InputError for bad options or input,
// Stopped when told to stop.
TrialResult runTrial(const HandDescription& hand, const SimulatedObject& object, const TrialInput& input,
                     const TrialOptions& options = {}, const StopToken& stop = {},
                     const TrialObserver& observer = {});

}  // namespace boxgrasp
