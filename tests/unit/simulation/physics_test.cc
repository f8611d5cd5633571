// The laws of mechanics, before any label is believed.
#include "boxgrasp/simulation/physics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace boxgrasp {
namespace {

const Matrix3d kInertia = Vector3d(2e-4, 3e-4, 4e-4).asDiagonal();
constexpr double kMass = 0.2, kGravity = 9.81;

TEST(Physics, FreeFallKeepsEnergyAndFallsHalfGTSquared) {
  PhysicsWorld world(0.001);
  const BodyId body = world.addBody(kMass, kInertia, Pose::Identity());
  for (int i = 0; i < 500; ++i) {
    world.push(body, Vector3d(0, 0, -kMass * kGravity));
    world.step({});
  }
  const double height = world.pose(body).translation().z(), speed = world.twist(body).velocity_W.z();
  EXPECT_NEAR(speed, -kGravity * 0.5, 1e-9);
  EXPECT_NEAR(height, -0.5 * kGravity * 0.25, kGravity * 0.5 * 0.001) << "more than one step's motion off";
  EXPECT_NEAR(0.5 * speed * speed + kGravity * height, 0.0, 0.01 * 0.5 * speed * speed);
}

// Without torque the angular momentum stays, in W, however an uneven body tumbles.
TEST(Physics, TumblingKeepsAngularMomentumAndEnergy) {
  PhysicsWorld world(0.001);
  const BodyId body = world.addBody(kMass, kInertia, Pose::Identity());
  world.setTwist(body, {Vector3d(0.1, 0, 0), Vector3d(0.2, 6.0, 0.3)});
  const auto momentum = [&] {
    const Matrix3d R_WB = world.pose(body).linear();
    return Vector3d(R_WB * kInertia * R_WB.transpose() * world.twist(body).angular_velocity_W);
  };
  const Vector3d before = momentum();
  const double energy = 0.5 * before.dot(world.twist(body).angular_velocity_W);
  for (int i = 0; i < 1000; ++i) world.step({});
  EXPECT_LT((momentum() - before).norm(), 0.02 * before.norm()) << momentum().transpose();
  EXPECT_NEAR(0.5 * momentum().dot(world.twist(body).angular_velocity_W), energy, 0.02 * energy);
  EXPECT_LT((world.pose(body).translation() - Vector3d(0.1, 0, 0)).norm(), 1e-9);
}

TEST(Physics, KinematicBodyArrivesWhereItIsSent) {
  PhysicsWorld world(0.002);
  const BodyId body = world.addKinematicBody(Pose::Identity());
  const Pose X_WB = makePose(Eigen::AngleAxisd(0.02, Vector3d(1, 2, 3).normalized()).toRotationMatrix(),
                             Vector3d(0.001, 0.002, -0.003));
  world.moveTo(body, X_WB);
  world.step({});
  EXPECT_TRUE(world.pose(body).isApprox(X_WB, 1e-9)) << world.pose(body).matrix();
}

// How far a block of 4 cm slides in a second down a slope, put down on its corners.
double slideOnSlope(double slope_rad, double friction, double turn_rad) {
  PhysicsWorld world(0.002);
  const BodyId ground = world.addKinematicBody(Pose::Identity());
  const Matrix3d inertia = kMass * 0.04 * 0.04 / 6 * Matrix3d::Identity();
  const BodyId block = world.addBody(kMass, inertia, makePose(Matrix3d::Identity(), Vector3d(0, 0, 0.02)));
  const Vector3d down(std::sin(slope_rad) * std::cos(turn_rad), std::sin(slope_rad) * std::sin(turn_rad),
                      -std::cos(slope_rad));
  for (int i = 0; i < 500; ++i) {
    std::vector<PhysicalContact> contacts;
    for (int corner = 0; corner < 4; ++corner) {
      const Vector3d p_W =
          world.pose(block) * Vector3d(corner & 1 ? 0.02 : -0.02, corner & 2 ? 0.02 : -0.02, -0.02);
      if (p_W.z() < 0) contacts.push_back({block, ground, p_W, Vector3d::UnitZ(), -p_W.z(), friction});
    }
    world.push(block, kMass * kGravity * down);
    world.step(contacts);
  }
  return world.pose(block).translation().head<2>().norm();
}

TEST(Physics, BlockOnASlopeHoldsBelowTheFrictionAngleAndSlidesAboveIt) {
  const double friction = 0.5, angle = std::atan(friction), two_degrees = 2 * std::numbers::pi / 180;
  for (const double turn : {0.0, 0.3, 0.25 * std::numbers::pi, 1.3}) {
    EXPECT_LT(slideOnSlope(angle - two_degrees, friction, turn), 0.002) << "turned by " << turn;
    const double steep = angle + two_degrees;
    const double expected = 0.5 * kGravity * (std::sin(steep) - friction * std::cos(steep));
    EXPECT_NEAR(slideOnSlope(steep, friction, turn), expected, 0.1 * expected) << "turned by " << turn;
  }
}

struct Balls {
  static constexpr double kRadius = 0.03;
  PhysicsWorld world{0.001};
  std::vector<BodyId> balls;
  std::vector<double> masses{0.2, 0.05};

  Balls() {
    for (int i = 0; i < 2; ++i) {
      const Vector3d at(i * 0.1, i * 0.02, i * -0.01);
      balls.push_back(world.addBody(masses[i], inertia(i), makePose(Matrix3d::Identity(), at)));
    }
    world.setTwist(balls[0], {Vector3d(1.0, 0.1, 0.0), Vector3d(5, -20, 10)});
    world.setTwist(balls[1], {Vector3d(-0.5, 0.0, 0.05), Vector3d(0, 10, 30)});
  }
  Matrix3d inertia(int i) const { return 0.4 * masses[i] * kRadius * kRadius * Matrix3d::Identity(); }
  bool step() {
    const Vector3d a = world.pose(balls[0]).translation(), b = world.pose(balls[1]).translation();
    const double depth = 2 * kRadius - (b - a).norm();
    std::vector<PhysicalContact> contacts;
    if (depth > 0) {
      contacts.push_back({balls[1], balls[0], 0.5 * (a + b), (b - a).normalized(), depth, 0.5});
    }
    world.step(contacts);
    return depth > 0;
  }
  double energy() const {
    double sum = 0;
    for (int i = 0; i < 2; ++i) {
      const Twist twist = world.twist(balls[i]);
      sum += 0.5 * masses[i] * twist.velocity_W.squaredNorm() +
             0.5 * twist.angular_velocity_W.dot(inertia(i) * twist.angular_velocity_W);
    }
    return sum;
  }
  Vector3d momentum() const {
    return masses[0] * world.twist(balls[0]).velocity_W + masses[1] * world.twist(balls[1]).velocity_W;
  }
  Vector3d angularMomentum() const {
    Vector3d sum = Vector3d::Zero();
    for (int i = 0; i < 2; ++i) {
      const Twist twist = world.twist(balls[i]);
      sum += masses[i] * world.pose(balls[i]).translation().cross(twist.velocity_W) +
             inertia(i) * twist.angular_velocity_W;
    }
    return sum;
  }
};

TEST(Physics, CollisionKeepsBothMomentaAndGainsNoEnergy) {
  Balls balls;
  const Vector3d momentum = balls.momentum(), angular = balls.angularMomentum();
  const double energy = balls.energy();
  int touched = 0;
  for (int i = 0; i < 300; ++i) touched += balls.step();
  EXPECT_GT(touched, 3) << "the balls missed each other";
  EXPECT_LT((balls.momentum() - momentum).norm(), 1e-9 * momentum.norm());
  EXPECT_LT((balls.angularMomentum() - angular).norm(), 1e-6 * angular.norm());
  EXPECT_LT(balls.energy(), energy);
}

TEST(Physics, DroppedBallNeverComesBackHigher) {
  PhysicsWorld world(0.002);
  const BodyId ground = world.addKinematicBody(Pose::Identity());
  const BodyId ball = world.addBody(kMass, kInertia, makePose(Matrix3d::Identity(), Vector3d(0, 0, 0.3)));
  std::vector<double> peaks{0.3};
  for (int i = 0; i < 2000; ++i) {
    const double z = world.pose(ball).translation().z(), rising = world.twist(ball).velocity_W.z();
    std::vector<PhysicalContact> contacts;
    if (z < 0) contacts.push_back({ball, ground, Vector3d(0, 0, z), Vector3d::UnitZ(), -z, 0.5});
    world.push(ball, Vector3d(0, 0, -kMass * kGravity));
    world.step(contacts);
    if (z > 0 && rising > 0 && world.twist(ball).velocity_W.z() <= 0) peaks.push_back(z);
    ASSERT_GT(z, -0.05) << "fell through the ground";
  }
  EXPECT_GT(peaks.size(), 1u) << "a soft ground makes a ball of this mass bounce";
  for (std::size_t i = 1; i < peaks.size(); ++i) EXPECT_LT(peaks[i], peaks[i - 1]) << "bounce " << i;
  EXPECT_NEAR(world.pose(ball).translation().z(), -kMass * kGravity / ContactMaterial{}.stiffness, 1e-5);
}

TEST(Physics, ContactForcesCarryTheWeight) {
  PhysicsWorld world(0.002);
  const BodyId ground = world.addKinematicBody(Pose::Identity());
  const BodyId ball = world.addBody(kMass, kInertia, Pose::Identity());
  std::vector<Vector3d> forces;
  for (int i = 0; i < 300; ++i) {
    const double depth = 0.001 - world.pose(ball).translation().z();
    world.push(ball, Vector3d(0, 0, -kMass * kGravity));
    forces = world.step({{ball, ground, Vector3d(0, 0, 0), Vector3d::UnitZ(), depth, 0.5}});
  }
  EXPECT_NEAR(forces.at(0).z(), kMass * kGravity, 1e-3);
  EXPECT_NEAR(0.001 - world.pose(ball).translation().z(), kMass * kGravity / ContactMaterial{}.stiffness,
              1e-6)
      << "the depth at rest is not weight / stiffness";
}

TEST(Physics, HingeStopsAtItsLimitAndYieldsToMoreTorqueThanItsMotorHas) {
  PhysicsWorld world(0.002);
  const BodyId base = world.addKinematicBody(Pose::Identity());
  const BodyId arm = world.addBody(kMass, kInertia, makePose(Matrix3d::Identity(), Vector3d(0.1, 0, 0)));
  const JointId hinge = world.addHinge(base, arm, Vector3d::Zero(), Vector3d::UnitY(), -1.0, 0.5);
  world.drive(hinge, 2.0, 1.0);
  for (int i = 0; i < 500; ++i) world.step({});
  EXPECT_NEAR(world.angle(hinge), 0.5, 1e-3);
  world.drive(hinge, 2.0, 0.1);
  for (int i = 0; i < 250; ++i) {
    world.push(arm, Vector3d(0, 0, 1.5));  // 0.15 N m against the motor
    world.step({});
  }
  EXPECT_LT(world.angle(hinge), 0.0) << "a motor of 0.1 N m resisted 0.15";
}

TEST(Physics, SliderMovesAlongItsAxisStopsAtItsLimitAndYieldsToMoreForceThanItsMotorHas) {
  PhysicsWorld world(0.002);
  const BodyId base = world.addKinematicBody(Pose::Identity());
  const BodyId jaw = world.addBody(kMass, kInertia, makePose(Matrix3d::Identity(), Vector3d(0.1, 0, 0)));
  const JointId slider = world.addSlider(base, jaw, -Vector3d::UnitX(), -0.01, 0.05);
  world.drive(slider, 0.1, 5.0);
  for (int i = 0; i < 100; ++i) world.step({});
  EXPECT_NEAR(world.place(slider), 0.02, 1e-3);
  EXPECT_NEAR(world.rate(slider), 0.1, 1e-3);
  EXPECT_NEAR(world.pose(jaw).translation().x(), 0.1 - world.place(slider), 1e-4);
  for (int i = 0; i < 400; ++i) world.step({});
  EXPECT_NEAR(world.place(slider), 0.05, 1e-3);
  for (int i = 0; i < 100; ++i) {
    world.push(jaw, Vector3d(6.0, 0, 0));
    world.step({});
  }
  EXPECT_LT(world.place(slider), 0.0) << "a motor of 5 N resisted 6";
}

}  // namespace
}  // namespace boxgrasp
