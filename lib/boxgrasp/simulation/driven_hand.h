// The hand as bodies in a physical world: four motors, three of which close one finger each; or one that
// closes two jaws.
#pragma once

#include <array>
#include <vector>

#include "boxgrasp/simulation/physics.h"
#include "boxgrasp/simulation/touch.h"

namespace boxgrasp {

// How a finger is driven (definitions, 3.3). One motor turns both joints: until the clutch opens, the outer
// by `coupling` of the inner. The clutch opens when the inner joint's load reaches breakaway_torque_nm; the
// inner link then stays, its worm gear not to be driven backwards below the hand's load limit, and the motor
// goes on to turn the outer link alone, faster, since the sum of both angles follows the motor. It turns the
// slower the nearer the heaviest loaded outer link of the hand is to max_tip_force, and back before it is
// reached: so no fingertip presses with more, and two fingers do not overwhelm the one between them. Once the
// grasp is locked, motors still press on where the load falls, but no load turns them back.
//
// Jaws are two bodies on sliders. One motor moves both, so that their ways are always the same: it presses
// with max_tip_force, and gives way to more. The rates below are the motor's; a jaw that touches stops both.
struct DriveOptions {
  // Of the inner joint until the object is touched: half of what the real hand can, which closes in about a
  // second.
  double closing_rate_rad_s = 1.22;
  // And then: slow, so that the object moves with the fingers and is not knocked about. Faster: more grasps
  // end by chance, which shows as labels that change with the step.
  double pressing_rate_rad_s = 0.8;
  double touch_torque_nm = 0.05;     // with which a finger that has touched waits for the others
  double breakaway_torque_nm = 0.5;  // of the clutch, at the inner joint; GraspIt!'s value
  double load_limit_n = 19.6;        // that a locked finger bears at its tip: 2 kg (definitions, 3.3)
  double stalled_share = 0.1;        // a joint slower than this share of its rate ...
  double stalled_time_s = 0.02;      // ... for this long has stalled
  void validate() const;
};

enum class DriveState { closing, clutch_open, stalled };

struct DrivenFinger {
  BodyId inner = nullptr, outer = nullptr;  // of a jaw: the same body, and F1 and F2 share theirs
  JointId inner_hinge = nullptr, outer_hinge = nullptr;  // of a jaw: its slider, and none
  double inner_start = 0.0, outer_start = 0.0;           // the joint angles at which the hinges were added
  DriveState state = DriveState::closing;
  bool paused = false;
  double lock_angle = 0.0;  // of the inner hinge, once the clutch is open
  double slow_time_s = 0.0;
};

struct DrivenPart {
  HandPart part;  // in the frame of its body
  BodyId body = nullptr;
};

// What the motors do and the clutches have done.
struct DriveMemory {
  std::array<DrivenFinger, 3> fingers;
  double rate = 0.0, load_n = 0.0;
  bool locked = false;
};

class DrivenHand {
 public:
  // With the palm in pose X_WP and these joints; the spread stays as it is. Keeps a reference to the world.
  DrivenHand(const HandDescription& hand, const HandJoints& joints, const Pose& X_WP,
             const DriveOptions& options, PhysicsWorld& world);

  // The force on the outer link that bears most, as its strain gauge says.
  void feel(double load_n) { load_n_ = load_n; }

  // Sets the motors for the next step and follows clutches and stalls; the motors press on after they
  // stalled.
  void drive();
  bool stalled() const;

  // Stops the finger of this part of the hand, with no more than the torque of a touch; the palm and the
  // knuckles on it stop nothing.
  void pause(std::size_t part);
  void resume();                   // all fingers, pressing
  void lock() { locked_ = true; }  // from now on no load turns a motor back
  bool waits() const;              // every finger is paused or has stalled

  DriveMemory memory() const { return {fingers_, rate_, load_n_, locked_}; }
  void recall(const DriveMemory& memory);

  HandJoints joints() const;
  std::array<double, 3> outerJoints() const;
  BodyId palm() const { return palm_; }
  const std::vector<DrivenPart>& parts() const { return parts_; }
  const std::array<DrivenFinger, 3>& fingers() const { return fingers_; }

  // Links of different fingers that meet, without friction.
  std::vector<PhysicalContact> selfContacts() const;

 private:
  void addFinger(int finger, const HandJoints& joints, const HandGeometry& geometry, const Pose& X_WP);
  void addJaw(const std::vector<Finger>& on_it, const HandJoints& joints, const HandGeometry& geometry,
              const Pose& X_WP);
  BodyId addLink(const Capsule& link_P, double mass_kg, const Pose& X_WP);
  void driveFinger(DrivenFinger& finger);
  void driveJaws();
  void follow(DrivenFinger& finger);

  HandDescription hand_;
  DriveOptions options_;
  PhysicsWorld& world_;
  double spread_, rate_, load_n_ = 0.0;
  bool locked_ = false;
  BodyId palm_ = nullptr;
  std::array<DrivenFinger, 3> fingers_;
  std::vector<DrivenPart> parts_;
};

}  // namespace boxgrasp
