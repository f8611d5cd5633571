#include "boxgrasp/simulation/scene.h"

#include <algorithm>
#include <array>

namespace boxgrasp {

GraspScene::GraspScene(const HandDescription& hand, const HandJoints& joints, const Pose& X_OP,
                       const SimulatedObject& object, const PhysicsOptions& options)
    : solid_(object),
      friction_(options.friction),
      world_(options.step_s, options.material),
      hand_(hand, joints, X_OP, options.drive, world_),
      object_(world_.addBody(options.mass_factor * object.mass_kg, options.mass_factor * object.inertia_O,
                             makePose(Matrix3d::Identity(), object.center_O))) {}

void GraspScene::restore(const SceneState& state) {
  world_.restore(state.world);
  hand_.recall(state.drive);
}

Pose GraspScene::objectInPalm() const { return palmPose().inverse() * world_.pose(object_); }

std::vector<PhysicalContact> GraspScene::findContacts() {
  std::vector<PhysicalContact> contacts;
  contacts_.clear();
  const Pose X_WO = world_.pose(object_) * makePose(Matrix3d::Identity(), -solid_.center_O);
  const Pose X_OW = X_WO.inverse();
  for (std::size_t i = 0; i < hand_.parts().size(); ++i) {
    const auto& [part, body] = hand_.parts()[i];
    const int most = part.finger < 0 ? kTouchesPerLink + 1 : kTouchesPerLink;
    for (const Touch& touch : touches(part, X_OW * world_.pose(body), solid_.field, most)) {
      contacts_.push_back({i, touch});
      contacts.push_back(
          {object_, body, X_WO * touch.p_O, X_WO.linear() * touch.normal_O, touch.depth, friction_});
    }
  }
  return contacts;
}

double GraspScene::heaviestLoad() const {
  std::array<double, 3> load_n{};
  for (const SceneContact& contact : contacts_) {
    const auto& [part, body] = hand_.parts()[contact.part];
    if (part.finger < 0 || body != hand_.fingers()[part.finger].outer) continue;
    load_n[part.finger] += contact.force_O.dot(contact.touch.normal_O);
  }
  return *std::max_element(load_n.begin(), load_n.end());
}

const std::vector<SceneContact>& GraspScene::step(const Pose& X_WP, const Vector3d& force_W) {
  world_.moveTo(hand_.palm(), X_WP);
  world_.push(object_, force_W);
  hand_.drive();
  std::vector<PhysicalContact> contacts = findContacts();
  const std::vector<PhysicalContact> among_links = hand_.selfContacts();
  contacts.insert(contacts.end(), among_links.begin(), among_links.end());
  const Matrix3d R_OW = world_.pose(object_).linear().transpose();
  const std::vector<Vector3d> forces_W = world_.step(contacts);
  for (std::size_t i = 0; i < contacts_.size(); ++i) contacts_[i].force_O = R_OW * forces_W[i];
  hand_.feel(heaviestLoad());
  return contacts_;
}

}  // namespace boxgrasp
