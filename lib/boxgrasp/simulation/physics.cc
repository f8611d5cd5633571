#include "boxgrasp/simulation/physics.h"

#include <ode/ode.h>

#include <algorithm>
#include <cassert>
#include <mutex>

namespace boxgrasp {
namespace {

static_assert(sizeof(dReal) == sizeof(double), "the engine must be built in double precision");

// Hinges are held to their axes this well: share of an error that one step removes, and softness.
constexpr double kHingeErp = 0.5;
constexpr double kSoftness = 1e-7;
// What sticks creeps a little, in the direction that it is pushed: 0.1 mm/s under 5 N. So the tangent of
// friction is that of the load before anything slips, and redundant contacts have one solution.
constexpr double kCreep = 2e-5;      // m/s per newton
constexpr double kSlipSpeed = 1e-7;  // m/s; slower slip has no direction

void ignoreMessage(int, const char*, va_list) {}
[[noreturn]] void fail(int, const char*, va_list) { throw PhysicsFailure(); }

// The engine's memory of this thread. Its messages about badly conditioned steps would go to stderr, where a
// library has no business; what they lead to shows in the poses.
void prepareThread() {
  static std::once_flag once;
  std::call_once(once, [] {
    dInitODE2(0);
    dSetMessageHandler(&ignoreMessage);
    dSetDebugHandler(&fail);  // otherwise the engine aborts the program
    dSetErrorHandler(&fail);
  });
  thread_local const bool ready = dAllocateODEDataForThread(dAllocateFlagBasicData) != 0;
  assert(ready);
  static_cast<void>(ready);
}

Vector3d vectorFrom(const dReal* v) { return {v[0], v[1], v[2]}; }

void setRotation(dBodyID body, const Matrix3d& R_WB) {
  dMatrix3 rotation = {};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) rotation[4 * row + column] = R_WB(row, column);
  }
  dBodySetRotation(body, rotation);
}

void setPose(dBodyID body, const Pose& X_WB) {
  const Vector3d& p = X_WB.translation();
  dBodySetPosition(body, p.x(), p.y(), p.z());
  setRotation(body, X_WB.linear());
}

dMass massOf(double mass_kg, const Matrix3d& I) {
  dMass mass;
  dMassSetParameters(&mass, mass_kg, 0, 0, 0, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
  return mass;
}

bool isSlider(JointId joint) { return dJointGetType(joint) == dJointTypeSlider; }

// The world's tangent for friction: along the slip, where the pyramid of friction touches the cone, so that a
// contact that gives way does so at the friction of the cone, whatever its direction.
void setTangent(dContact& contact, const Vector3d& slip_W, const Vector3d& normal_W) {
  const Vector3d along_W = slip_W - normal_W * normal_W.dot(slip_W);
  const double speed = along_W.norm();
  if (!(speed > kSlipSpeed)) return;
  contact.surface.mode |= dContactFDir1;
  for (int i = 0; i < 3; ++i) contact.fdir1[i] = along_W[i] / speed;
}

// What the pad presses with at this depth and speed of the pusher into the pushed body. Friction is bounded
// by this rather than by the engine's own normal force, which it takes from a solution without friction: that
// may be far from the one with it, and then labels depend on the step.
double pressure(const ContactMaterial& material, double depth, double closing_speed) {
  return std::max(0.0, material.stiffness * depth + material.damping * closing_speed);
}

}  // namespace

// The engine's default threading is one object that all worlds share and that only one thread may use; so
// each world brings its own.
struct PhysicsWorld::Impl {
  dThreadingImplementationID threading;
  dWorldID world;
  dJointGroupID contacts, holds;
  std::vector<dBodyID> bodies;
  bool failed = false;  // in a step: the threading then holds unfinished work and cannot be freed

  Impl()
      : threading(dThreadingAllocateSelfThreadedImplementation()),
        world(dWorldCreate()),
        contacts(dJointGroupCreate(0)),
        holds(dJointGroupCreate(0)) {
    dWorldSetStepThreadingImplementation(world, dThreadingImplementationGetFunctions(threading), threading);
    dWorldSetERP(world, kHingeErp);
    dWorldSetCFM(world, kSoftness);
  }
  ~Impl() {
    dJointGroupDestroy(contacts);
    dJointGroupDestroy(holds);
    dWorldDestroy(world);
    if (!failed) dThreadingFreeImplementation(threading);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  dBodyID addBody(const Pose& X_WB) {
    const dBodyID body = dBodyCreate(world);
    setPose(body, X_WB);
    dBodySetFiniteRotationMode(body, 1);
    bodies.push_back(body);
    return body;
  }
};

PhysicsWorld::PhysicsWorld(double step_s, const ContactMaterial& material)
    : step_s_(step_s), material_(material) {
  prepareThread();
  impl_ = std::make_unique<Impl>();
}

PhysicsWorld::~PhysicsWorld() = default;

BodyId PhysicsWorld::addBody(double mass_kg, const Matrix3d& inertia_B, const Pose& X_WB) {
  const dBodyID body = impl_->addBody(X_WB);
  const dMass mass = massOf(mass_kg, inertia_B);
  dBodySetMass(body, &mass);
  return body;
}

BodyId PhysicsWorld::addKinematicBody(const Pose& X_WB) {
  const dBodyID body = impl_->addBody(X_WB);
  dBodySetKinematic(body);
  return body;
}

JointId PhysicsWorld::addHinge(BodyId parent, BodyId child, const Vector3d& anchor_W, const Vector3d& axis_W,
                               double lowest, double highest) {
  const dJointID hinge = dJointCreateHinge(impl_->world, nullptr);
  dJointAttach(hinge, child, parent);
  dJointSetHingeAnchor(hinge, anchor_W.x(), anchor_W.y(), anchor_W.z());
  dJointSetHingeAxis(hinge, axis_W.x(), axis_W.y(), axis_W.z());
  dJointSetHingeParam(hinge, dParamLoStop, lowest);
  dJointSetHingeParam(hinge, dParamHiStop, highest);
  return hinge;
}

// The engine's axis of a slider is along the first body's way relative to the second.
JointId PhysicsWorld::addSlider(BodyId parent, BodyId child, const Vector3d& axis_W, double lowest,
                                double highest) {
  const dJointID slider = dJointCreateSlider(impl_->world, nullptr);
  dJointAttach(slider, child, parent);
  dJointSetSliderAxis(slider, axis_W.x(), axis_W.y(), axis_W.z());
  dJointSetSliderParam(slider, dParamLoStop, lowest);
  dJointSetSliderParam(slider, dParamHiStop, highest);
  return slider;
}

void PhysicsWorld::drive(JointId joint, double rate, double effort) {
  const auto set = isSlider(joint) ? dJointSetSliderParam : dJointSetHingeParam;
  set(joint, dParamVel, rate);
  set(joint, dParamFMax, effort);
}

double PhysicsWorld::angle(JointId hinge) const { return dJointGetHingeAngle(hinge); }
double PhysicsWorld::place(JointId slider) const { return dJointGetSliderPosition(slider); }
double PhysicsWorld::rate(JointId joint) const {
  return isSlider(joint) ? dJointGetSliderPositionRate(joint) : dJointGetHingeAngleRate(joint);
}

void PhysicsWorld::hold(BodyId body, double force, double torque) {
  const dJointID linear = dJointCreateLMotor(impl_->world, impl_->holds);
  const dJointID angular = dJointCreateAMotor(impl_->world, impl_->holds);
  dJointAttach(linear, body, nullptr);
  dJointAttach(angular, body, nullptr);
  dJointSetLMotorNumAxes(linear, 3);
  dJointSetAMotorNumAxes(angular, 3);
  for (int i = 0; i < 3; ++i) {
    const int group = i * dParamGroup;
    dJointSetLMotorAxis(linear, i, 0, i == 0, i == 1, i == 2);
    dJointSetAMotorAxis(angular, i, 0, i == 0, i == 1, i == 2);
    dJointSetLMotorParam(linear, group + dParamFMax, force);
    dJointSetAMotorParam(angular, group + dParamFMax, torque);
  }
}

void PhysicsWorld::release() { dJointGroupEmpty(impl_->holds); }

void PhysicsWorld::moveTo(BodyId body, const Pose& X_WB) {
  const Pose now = pose(body);
  const Eigen::AngleAxisd turn(Matrix3d(X_WB.linear() * now.linear().transpose()));
  setTwist(body, {(X_WB.translation() - now.translation()) / step_s_, turn.angle() / step_s_ * turn.axis()});
}

void PhysicsWorld::setTwist(BodyId body, const Twist& twist) {
  const Vector3d &v = twist.velocity_W, &w = twist.angular_velocity_W;
  dBodySetLinearVel(body, v.x(), v.y(), v.z());
  dBodySetAngularVel(body, w.x(), w.y(), w.z());
}

void PhysicsWorld::push(BodyId body, const Vector3d& force_W) {
  dBodyAddForce(body, force_W.x(), force_W.y(), force_W.z());
}

WorldState PhysicsWorld::state() const {
  WorldState state;
  for (const dBodyID body : impl_->bodies) {
    state.poses.push_back(pose(body));
    state.twists.push_back(twist(body));
  }
  return state;
}

void PhysicsWorld::restore(const WorldState& state) {
  for (std::size_t i = 0; i < impl_->bodies.size(); ++i) {
    setPose(impl_->bodies[i], state.poses[i]);
    setTwist(impl_->bodies[i], state.twists[i]);
  }
}

Pose PhysicsWorld::pose(BodyId body) const {
  const dReal* rotation = dBodyGetRotation(body);
  Matrix3d R_WB;
  for (int row = 0; row < 3; ++row) R_WB.row(row) = vectorFrom(rotation + 4 * row).transpose();
  return makePose(R_WB, vectorFrom(dBodyGetPosition(body)));
}

Twist PhysicsWorld::twist(BodyId body) const {
  return {vectorFrom(dBodyGetLinearVel(body)), vectorFrom(dBodyGetAngularVel(body))};
}

Vector3d PhysicsWorld::velocityAt(BodyId body, const Vector3d& p_W) const {
  const Twist moving = twist(body);
  return moving.velocity_W + moving.angular_velocity_W.cross(p_W - vectorFrom(dBodyGetPosition(body)));
}

std::vector<Vector3d> PhysicsWorld::step(const std::vector<PhysicalContact>& contacts) {
  std::vector<dJointFeedback> feedback(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const PhysicalContact& from = contacts[i];
    dContact contact = {};
    const Vector3d slip_W = velocityAt(from.pushed, from.p_W) - velocityAt(from.pusher, from.p_W);
    contact.surface.mode = dContactSoftERP | dContactSoftCFM | dContactSlip1 | dContactSlip2;
    contact.surface.mu = from.friction * pressure(material_, from.depth, -slip_W.dot(from.normal_W));
    contact.surface.slip1 = contact.surface.slip2 = kCreep;
    const double impulse = step_s_ * material_.stiffness + material_.damping;
    contact.surface.soft_erp = step_s_ * material_.stiffness / impulse;
    contact.surface.soft_cfm = 1.0 / impulse;
    contact.geom.depth = from.depth;
    for (int k = 0; k < 3; ++k) {
      contact.geom.pos[k] = from.p_W[k];
      contact.geom.normal[k] = from.normal_W[k];
    }
    setTangent(contact, slip_W, from.normal_W);
    const dJointID joint = dJointCreateContact(impl_->world, impl_->contacts, &contact);
    dJointAttach(joint, from.pushed, from.pusher);
    dJointSetFeedback(joint, &feedback[i]);
  }
  impl_->failed = true;
  dWorldStep(impl_->world, step_s_);
  impl_->failed = false;
  dJointGroupEmpty(impl_->contacts);
  std::vector<Vector3d> forces_W;
  for (const dJointFeedback& f : feedback) forces_W.push_back(vectorFrom(f.f1));
  return forces_W;
}

}  // namespace boxgrasp
