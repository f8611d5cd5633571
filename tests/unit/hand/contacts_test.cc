#include "boxgrasp/hand/contacts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "boxgrasp/base/error.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

constexpr double kCell_m = 0.006;
constexpr double kSpacing_m = 0.002;

// An upright cylinder's side in F: its axis along z, from z = 0 (the face) down.
PointCloud cylinder(double radius, double height, double spacing = kSpacing_m) {
  PointCloud cloud_F;
  const int around = static_cast<int>(6.2832 * radius / spacing);
  for (int i = 0; i < around; ++i) {
    for (double z = 0; z <= height; z += spacing)
      cloud_F.push({radius * std::cos(6.2832 * i / around), radius * std::sin(6.2832 * i / around), z});
  }
  return cloud_F;
}

// Three points on a circle, pushed on towards its middle, all at one depth.
struct Planned {
  Triplet triplet;
  HandConfiguration configuration;
};
Planned planned(double radius, double depth) {
  Planned result;
  for (int i = 0; i < 3; ++i) {
    const double angle = 0.3 + 2.0944 * i;
    result.triplet.points_F[i] = radius * Vector2d(std::cos(angle), std::sin(angle));
    result.triplet.normals_F[i] = -result.triplet.points_F[i].normalized();
  }
  result.configuration.point_of_finger = {1, 2, 0};
  result.configuration.depth_m = {depth, depth, depth};
  return result;
}

Face faceAt(const Pose& X_CF) {
  Face face;
  face.X_CF = X_CF;
  return face;
}

Contacts contactsOn(const PointCloud& cloud_F, const Planned& plan, double spacing = kSpacing_m,
                    const Viewpoints& viewpoints_F = {}) {
  const PointGrid grid_F(cloud_F, kCell_m);
  TouchedSurface surface_F(grid_F, spacing);
  return findContacts(faceAt(Pose::Identity()), plan.triplet, plan.configuration, surface_F, viewpoints_F);
}

// What one grasp had fitted serves the next, and changes nothing.
TEST(FindContacts, AreTheSameOnASurfaceThatOthersTouched) {
  const PointCloud cloud_F = cylinder(0.04, 0.1);
  const PointGrid grid_F(cloud_F, kCell_m);
  TouchedSurface shared_F(grid_F, kSpacing_m);
  for (const double radius : {0.038, 0.040, 0.043}) {
    for (const double depth : {0.02, 0.03, 0.021, 0.08}) {
      const Planned plan = planned(radius, depth);
      const Contacts found =
          findContacts(faceAt(Pose::Identity()), plan.triplet, plan.configuration, shared_F, {});
      const Contacts alone = contactsOn(cloud_F, plan);
      ASSERT_EQ(found.rejection, alone.rejection) << "radius " << radius << ", depth " << depth;
      for (int finger = 0; finger < 3; ++finger) {
        EXPECT_EQ(found.contacts[finger].p_C, alone.contacts[finger].p_C) << "finger " << finger;
        EXPECT_EQ(found.contacts[finger].normal_C, alone.contacts[finger].normal_C) << "finger " << finger;
      }
    }
  }
}

// Planned a little inside or outside of the surface, the contact lies on it, and its normal points to the
// axis; the finger's order is the configuration's. In any pose of the cloud.
TEST(FindContacts, LieOnTheSurfaceAndPointIntoTheObject) {
  std::mt19937_64 random(1);
  const double radius = 0.04;
  const PointCloud cloud_F = cylinder(radius, 0.1);
  for (const double off : {-0.003, 0.0, 0.004}) {
    const Planned plan = planned(radius + off, 0.03);
    for (int trial = 0; trial < 20; ++trial) {
      const Pose X_CF = test::randomPose(random);
      const PointCloud cloud_C = transformed(cloud_F, X_CF);
      const PointGrid grid_C(cloud_C, kCell_m);
      TouchedSurface surface_C(grid_C, kSpacing_m);
      const Contacts found = findContacts(faceAt(X_CF), plan.triplet, plan.configuration, surface_C, {});
      ASSERT_FALSE(found.rejection);
      for (int finger = 0; finger < 3; ++finger) {
        const int point = plan.configuration.point_of_finger[finger];
        const Vector2d on_surface = radius * plan.triplet.points_F[point].normalized();
        const Vector3d p_F = X_CF.inverse() * found.contacts[finger].p_C;
        const Vector3d n_F = X_CF.linear().transpose() * found.contacts[finger].normal_C;
        EXPECT_LT((p_F - Vector3d(on_surface.x(), on_surface.y(), 0.03)).norm(), 0.001)
            << "planned " << off << " off";
        EXPECT_GT(n_F.head<2>().dot(plan.triplet.normals_F[point]), 0.99);
        EXPECT_NEAR(n_F.norm(), 1.0, 1e-9);
      }
    }
  }
}

TEST(FindContacts, RefuseAPlaceWithoutSurface) {
  const PointCloud cloud_F = cylinder(0.04, 0.05);
  EXPECT_EQ(contactsOn(cloud_F, planned(0.06, 0.03)).rejection, ContactRejection::no_surface)
      << "20 mm beside it";
  EXPECT_EQ(contactsOn(cloud_F, planned(0.04, 0.08)).rejection, ContactRejection::no_surface)
      << "30 mm below its end";
  EXPECT_EQ(contactsOn(cloud_F, planned(0.04, 0.056)).rejection, ContactRejection::no_surface)
      << "6 mm below its end: the plane goes on, the surface does not";
  EXPECT_FALSE(contactsOn(cloud_F, planned(0.04, 0.051)).rejection) << "1 mm below its end";
}

// On a flat roof with a steep or a gentle slope.
TEST(FindContacts, RefuseASurfaceThatFacesAway) {
  const auto slope = [](double tilt) {
    // A plane through each point of the plan, leaning by `tilt` from the region's normal towards the hand.
    PointCloud cloud_F;
    for (const Vector2d& p : planned(0.04, 0.03).triplet.points_F) {
      const Vector3d n(p.x() / p.norm() * std::cos(tilt), p.y() / p.norm() * std::cos(tilt), -std::sin(tilt));
      const Vector3d u = n.unitOrthogonal(), v = n.cross(u);
      for (int i = -8; i <= 8; ++i) {
        for (int j = -8; j <= 8; ++j)
          cloud_F.push(Vector3d(p.x(), p.y(), 0.03) + 0.001 * i * u + 0.001 * j * v);
      }
    }
    return cloud_F;
  };
  EXPECT_EQ(contactsOn(slope(1.2), planned(0.04, 0.03)).rejection, ContactRejection::facing_away);
  const Contacts gentle = contactsOn(slope(0.9), planned(0.04, 0.03));
  ASSERT_FALSE(gentle.rejection);
  EXPECT_NEAR(gentle.contacts[0].normal_C.z(), std::sin(0.9), 1e-3)
      << "into the object: down, where it leans towards the hand";
}

// The top of a disc seen from straight above its middle: no wall is seen. From far to one side, the walls on
// that side would be in the cloud if they were there.
TEST(FindContacts, TakeTheOutlineForWallsThatTheSensorCannotSee) {
  const double radius = 0.04;
  PointCloud top_F;
  for (double x = -radius; x <= radius; x += 0.001) {
    for (double y = -radius; y <= radius; y += 0.001) {
      if (std::hypot(x, y) <= radius) top_F.push({x, y, 0.03});
    }
  }
  const Planned plan = planned(radius, 0.032);
  EXPECT_EQ(contactsOn(top_F, plan).rejection, ContactRejection::facing_away)
      << "nothing is known of the sensor";
  const Contacts found = contactsOn(top_F, plan, kSpacing_m, {{0, 0, -1}});
  ASSERT_FALSE(found.rejection);
  for (int finger = 0; finger < 3; ++finger) {
    const int point = plan.configuration.point_of_finger[finger];
    EXPECT_FALSE(found.contacts[finger].seen);
    EXPECT_LT((found.contacts[finger].normal_C.head<2>() - plan.triplet.normals_F[point]).norm(), 1e-9);
    EXPECT_LT((found.contacts[finger].p_C.head<2>() - plan.triplet.points_F[point]).norm(), 1e-9);
  }
  EXPECT_TRUE(contactsOn(top_F, plan, kSpacing_m, {{10, 0, 0.03}}).rejection)
      << "one finger's wall would be seen";
  EXPECT_TRUE(contactsOn(top_F, plan, kSpacing_m, {{0, 0, -1}, {10, 0, 0.03}}).rejection)
      << "by the second of two sensors";
  EXPECT_EQ(contactsOn(top_F, planned(radius, 0.04), kSpacing_m, {{0, 0, -1}}).rejection,
            ContactRejection::no_surface)
      << "10 mm below all that was seen";
}

// A cloud with a point every 8 mm has too few neighbours within 8 mm: the neighbourhood grows.
TEST(FindContacts, WorkOnSparseClouds) {
  const double radius = 0.05, spacing = 0.008;
  const Contacts found = contactsOn(cylinder(radius, 0.1, spacing), planned(radius, 0.04), spacing);
  ASSERT_FALSE(found.rejection);
  for (const SurfaceContact& contact : found.contacts) {
    const Vector2d outwards = contact.p_C.head<2>().normalized();
    EXPECT_NEAR(contact.p_C.head<2>().norm(), radius, 0.004);
    EXPECT_LT(contact.normal_C.head<2>().dot(outwards), -0.95);
  }
}

TEST(FindContacts, AnEmptyCloudHasNoSurface) {
  EXPECT_EQ(contactsOn(PointCloud{}, planned(0.04, 0.03)).rejection, ContactRejection::no_surface);
}

TEST(ContactOptions, NameTheBadField) {
  ContactOptions options;
  EXPECT_NO_THROW(options.validate());
  options.normal_radius_m = -1;
  try {
    options.validate();
    ADD_FAILURE() << "a negative radius was taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("normal_radius_m' is -1"));
  }
}

// A round object that narrows towards its foot, in F: at depth z its radius is radius(z).
struct Vase {
  double top_radius, narrowing;  // tangent of the wall's lean
  double height = 0.07;

  double radius(double z) const { return top_radius - narrowing * z; }
  // Signed distance of a point from the wall.
  double distance(const Vector3d& p) const {
    return (p.head<2>().norm() - radius(p.z())) / std::hypot(1.0, narrowing);
  }
  PointCloud cloud() const {
    PointCloud cloud_F;
    for (double z = 0; z <= height; z += 0.001) {
      for (int i = 0; i < 240; ++i) {
        const double angle = (i + 0.5 * std::fmod(z, 0.002)) * 0.0261799;
        cloud_F.push({radius(z) * std::cos(angle), radius(z) * std::sin(angle), z});
      }
    }
    return cloud_F;
  }
  // What the outline tells: a circle as wide as the top.
  Triplet triplet() const {
    Triplet outline = planned(top_radius, 0.0).triplet;
    outline.nearest_depth_m.fill(0.0);
    outline.farthest_depth_m.fill(height);
    return outline;
  }
};

// Brute force over the joint angle: closing from wide open, the finger's tip comes to the object just there.
double angleOfTouch(const HandDescription& hand, const Pose& X_FP, const HandJoints& joints, int finger,
                    const Vase& vase) {
  HandJoints closing = joints;
  for (double inner = hand.inner_min; inner < hand.inner_max; inner += 2e-4) {
    closing.inner.fill(inner);
    if (vase.distance(X_FP * forwardKinematics(hand, closing).tips_P[finger]) <= hand.tip_radius)
      return inner;
  }
  return NAN;
}

TEST(MeetSurface, ClosesEachFingerUntilItsTipIsOnTheObjectAtItsOwnDepth) {
  const HandDescription& hand = barrettHand();
  std::mt19937_64 random(3);
  int met = 0;
  double worst_outline = 0.0;
  for (const double narrowing : {0.0, 0.05, 0.10, 0.15}) {
    const Vase vase{0.035, narrowing};
    const Pose X_CF = test::randomPose(random);
    const PointCloud cloud_C = transformed(vase.cloud(), X_CF);
    const PointGrid grid(cloud_C, kCell_m);
    TouchedSurface surface(grid, 0.001);
    const Triplet triplet = vase.triplet();
    for (const HandConfiguration& hand_on : findConfigurations(hand, triplet, 0).configurations) {
      const Contacts outline = findContacts(faceAt(X_CF), triplet, hand_on, surface, {});
      if (outline.rejection) continue;
      HandJoints joints = hand_on.joints;
      const Contacts found = meetSurface(hand, X_CF * hand_on.X_FP, joints, outline, surface);
      ASSERT_FALSE(found.rejection) << describe(*found.rejection);
      for (int finger = 0; finger < 3; ++finger) {
        const Vector3d contact_F = X_CF.inverse() * found.contacts[finger].p_C;
        const Vector3d tip_F = hand_on.X_FP * forwardKinematics(hand, joints).tips_P[finger];
        EXPECT_NEAR(vase.distance(contact_F), 0.0, 1e-6) << "the contact is on the object";
        EXPECT_NEAR((contact_F - tip_F).norm(), hand.tip_radius, 1e-6) << "and the fingertip at the contact";
        EXPECT_NEAR(joints.inner[finger], angleOfTouch(hand, hand_on.X_FP, joints, finger, vase), 0.002);
        const Vector3d before_F = hand_on.X_FP * forwardKinematics(hand, hand_on.joints).tips_P[finger];
        worst_outline = std::max(worst_outline, std::abs(vase.distance(before_F) - hand.tip_radius));
        ++met;
      }
    }
  }
  EXPECT_GT(met, 100);
  EXPECT_GT(worst_outline, 0.002) << "the outline alone leaves fingertips beside the object";
}

TEST(MeetSurface, LeavesContactsThatNobodySawAsTheyAre) {
  const HandDescription& hand = barrettHand();
  const Vase vase{0.035, 0.1};
  const PointCloud cloud_F = vase.cloud();
  const HandConfiguration hand_on = findConfigurations(hand, vase.triplet(), 0).configurations.front();
  const PointGrid grid(cloud_F, kCell_m);
  TouchedSurface surface(grid, 0.001);
  Contacts contacts = findContacts(faceAt(Pose::Identity()), vase.triplet(), hand_on, surface, {});
  ASSERT_FALSE(contacts.rejection);
  for (SurfaceContact& contact : contacts.contacts) contact.seen = false;
  HandJoints joints = hand_on.joints;
  const Contacts same = meetSurface(hand, hand_on.X_FP, joints, contacts, surface);
  for (int finger = 0; finger < 3; ++finger) {
    EXPECT_EQ(same.contacts[finger].p_C, contacts.contacts[finger].p_C);
    EXPECT_EQ(joints.inner[finger], hand_on.joints.inner[finger]);
  }
}

}  // namespace
}  // namespace boxgrasp
