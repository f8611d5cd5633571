// Rigid bodies in motion: the little of the Open Dynamics Engine that a grasp needs.
#pragma once

#include <exception>
#include <memory>
#include <vector>

#include "boxgrasp/geometry/pose.h"

struct dxBody;
struct dxJoint;

namespace boxgrasp {

using BodyId = dxBody*;    // of one world, valid as long as that
using JointId = dxJoint*;  // likewise

// The engine could not solve a step. The world can be destroyed, but not stepped again.
struct PhysicsFailure : std::exception {
  const char* what() const noexcept override { return "the physics engine could not solve a step"; }
};

struct Twist {
  Vector3d velocity_W = Vector3d::Zero();          // of the body's origin, m/s
  Vector3d angular_velocity_W = Vector3d::Zero();  // rad/s
};

// Poses and twists of all bodies of a world, in the order in which they were added.
struct WorldState {
  std::vector<Pose> poses;
  std::vector<Twist> twists;
};

// Stiffness and damping of the surfaces in contact, so that what happens does not depend on the step.
struct ContactMaterial {
  double stiffness = 2e4;  // N/m: 15 N press a rubber pad in by 0.75 mm
  double damping = 50.0;   // N s/m: critical for 30 g on one contact
};

struct PhysicalContact {
  BodyId pushed = nullptr, pusher = nullptr;
  Vector3d p_W = Vector3d::Zero();
  Vector3d normal_W = Vector3d::Zero();  // unit, from the pusher into the pushed body
  double depth = 0.0;                    // metres; negative: apart
  double friction = 0.0;
};

// One world W without gravity. Not shared between threads, but many may run at once. Everything is
// deterministic: the exact solver of mixed linear complementarity problems takes no random numbers.
class PhysicsWorld {
 public:
  explicit PhysicsWorld(double step_s, const ContactMaterial& material = {});
  ~PhysicsWorld();
  PhysicsWorld(const PhysicsWorld&) = delete;
  PhysicsWorld& operator=(const PhysicsWorld&) = delete;

  // The body's origin is its centre of mass; the inertia is about it, in the body's axes.
  BodyId addBody(double mass_kg, const Matrix3d& inertia_B, const Pose& X_WB);
  // Of infinite mass: moves as moveTo() says, and nothing can stop it.
  BodyId addKinematicBody(const Pose& X_WB);
  // The angle is 0 in the poses at the time of adding, grows as the child turns about the axis, and stays
  // within [lowest, highest].
  JointId addHinge(BodyId parent, BodyId child, const Vector3d& anchor_W, const Vector3d& axis_W,
                   double lowest, double highest);

  // The place is 0 in the poses at the time of adding, grows as the child moves along the axis, and stays
  // within [lowest, highest], metres.
  JointId addSlider(BodyId parent, BodyId child, const Vector3d& axis_W, double lowest, double highest);

  // Drives the joint at this rate, in rad/s or m/s, with at most this torque or force, in N m or N, until
  // driven otherwise.
  void drive(JointId joint, double rate, double effort);
  double angle(JointId hinge) const;
  double place(JointId slider) const;
  double rate(JointId joint) const;

  // Holds the body where it is, as friction on a support would, with at most this force and torque about each
  // axis; release() lets it go.
  void hold(BodyId body, double force, double torque);
  void release();

  // Brings a kinematic body to this pose during the next step.
  void moveTo(BodyId body, const Pose& X_WB);
  void setTwist(BodyId body, const Twist& twist);
  void push(BodyId body, const Vector3d& force_W);  // at its centre of mass, during the next step

  WorldState state() const;
  // Pre: of this world, since when no body was added. What drives hinges and holds bodies stays as it is.
  void restore(const WorldState& state);

  Pose pose(BodyId body) const;
  Twist twist(BodyId body) const;
  Vector3d velocityAt(BodyId body, const Vector3d& p_W) const;

  // Takes one step with these contacts; returns the force of each on its pushed body, in W. Throws
  // PhysicsFailure.
  std::vector<Vector3d> step(const std::vector<PhysicalContact>& contacts);
  double stepSize() const { return step_s_; }

 private:
  struct Impl;
  double step_s_;
  ContactMaterial material_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace boxgrasp
