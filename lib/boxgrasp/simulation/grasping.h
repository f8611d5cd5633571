// One grasp as it runs: the hand comes and closes; then whoever tests the grasp moves hand and object.
#pragma once

#include <optional>

#include "boxgrasp/simulation/motions.h"
#include "boxgrasp/simulation/trial.h"

namespace boxgrasp {

// Keeps references to hand, object, input and options. Where a stage returns false, it has ended the trial
// and result().outcome says how. The world W is the object's frame O as it was at the start.
class Grasping {
 public:
  // Throws InputError for bad options or input.
  Grasping(const HandDescription& hand, const SimulatedObject& object, const TrialInput& input,
           const TrialOptions& options, const StopToken& stop, const TrialObserver& observer = {});

  // Comes, closes and lets go of the support: fills in the contacts and their quality.
  bool grasp();

  // One step with the palm where it is to stay, or in X_WP, and this force on the object.
  void step(const Vector3d& force_W) { step(X_WP_, force_W); }
  void step(const Pose& X_WP, const Vector3d& force_W);
  // Steps for this long, or until the object is lost, as the phase has it: then false.
  bool rest(double time_s, const Vector3d& force_W);
  // Moves the palm as the motion says, starting from where it is to stay, which then is where the motion
  // ended; under the object's weight. False as for rest().
  bool carry(const PalmMotion& motion);

  // The object's movement in the palm since it was grasped, or since mark().
  void mark() { X_PG_mark_ = scene_->objectInPalm(); }
  double slip() const;      // of the centre of mass, metres
  double rotation() const;  // radians
  // Not a number counts as moved: whatever the physics could not solve is not held.
  bool movedBeyond(double limit_m) const { return !(slip() <= limit_m); }

  // The object has moved farther than the options allow in this phase.
  bool lost() const {
    return movedBeyond(phase_ < TrialPhase::lift ? options_.lost_m : options_.slip_limit_m);
  }

  Vector3d weight_W() const;
  double mass() const;  // kg
  const Pose& palm() const { return X_WP_; }
  GraspScene& scene() { return *scene_; }
  void enter(TrialPhase phase) { phase_ = phase; }
  bool ends(TrialOutcome outcome);
  TrialResult& result() { return result_; }

  // All that later steps depend on, so that several tests can start from one closed hand.
  struct State {
    SceneState scene;
    Pose X_WP, X_PG_mark;
  };
  State state() const { return {scene_->state(), X_WP_, X_PG_mark_}; }
  void restore(const State& state);

 private:
  bool approach();
  void touch();
  bool close();
  bool settle();
  bool letGo();
  void readHand();
  std::vector<TrialContact> pressing() const;
  GraspQuality qualityOf(const std::vector<TrialContact>& touches) const;
  void showApproach(const Pose& X_OP) const;
  void showScene() const;

  const HandDescription& hand_;
  const SimulatedObject& object_;
  const TrialInput& input_;
  const TrialOptions& options_;
  StopToken stop_;
  TrialObserver observer_;
  TrialPhase phase_ = TrialPhase::approach;
  TrialResult result_;
  std::optional<GraspScene> scene_;
  Pose X_WP_ = Pose::Identity();       // where the palm is to stay
  Pose X_PG_mark_ = Pose::Identity();  // of the object in the palm
};

}  // namespace boxgrasp
