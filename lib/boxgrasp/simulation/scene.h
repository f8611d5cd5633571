// A hand and an object in one physical world.
#pragma once

#include <vector>

#include "boxgrasp/simulation/driven_hand.h"
#include "boxgrasp/simulation/object.h"

namespace boxgrasp {

// The hand touches the object in at most this many points a link, the ends of a line, and one more with the
// palm.
inline constexpr int kTouchesPerLink = 2;

struct SceneContact {
  std::size_t part = 0;  // index into DrivenHand::parts
  Touch touch;
  Vector3d force_O = Vector3d::Zero();  // on the object, newtons
};

struct PhysicsOptions {
  // Half of it ends about 1 % of grasps with another word.
  double step_s = 0.002;
  double friction = 0.5;
  double mass_factor = 1.0;  // of the object's mass and inertia: to ask what another weight would do
  ContactMaterial material;
  DriveOptions drive;
  void validate() const;
};

// All that later steps depend on.
struct SceneState {
  WorldState world;
  DriveMemory drive;
};

// The world W is the object's frame O as it was at the start.
class GraspScene {
 public:
  // With the palm in pose X_OP.
  GraspScene(const HandDescription& hand, const HandJoints& joints, const Pose& X_OP,
             const SimulatedObject& object, const PhysicsOptions& options);

  // One step, in which the palm moves to X_WP and this force acts on the object's centre of mass. Returns the
  // contacts of hand and object during the step.
  const std::vector<SceneContact>& step(const Pose& X_WP, const Vector3d& force_W);

  SceneState state() const { return {world_.state(), hand_.memory()}; }
  void restore(const SceneState& state);

  PhysicsWorld& world() { return world_; }
  const PhysicsWorld& world() const { return world_; }
  DrivenHand& hand() { return hand_; }
  const DrivenHand& hand() const { return hand_; }
  BodyId object() const { return object_; }
  double stepSize() const { return world_.stepSize(); }
  Pose palmPose() const { return world_.pose(hand_.palm()); }              // X_WP
  Pose objectInPalm() const;                                               // of the centre of mass, axes of O
  const std::vector<SceneContact>& contacts() const { return contacts_; }  // of the last step
  const SimulatedObject& solid() const { return solid_; }

 private:
  std::vector<PhysicalContact> findContacts();
  double heaviestLoad() const;  // of an outer link by the object, newtons

  const SimulatedObject& solid_;
  double friction_;
  PhysicsWorld world_;
  DrivenHand hand_;
  BodyId object_;
  std::vector<SceneContact> contacts_;
};

}  // namespace boxgrasp
