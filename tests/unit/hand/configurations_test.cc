#include "boxgrasp/hand/configurations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/tolerances.h"
#include "random_grasp.h"

namespace boxgrasp {
namespace {

using test::KnownGrasp;
using test::turned;

constexpr double kFriction = 0.4;
const double kCone = std::atan(kFriction);

ConfigurationOptions keepingAll() {
  ConfigurationOptions options;
  options.friction = kFriction;
  options.min_turn_rad = 0.0;
  return options;
}

Vector3d raised(const Vector2d& p, double z) { return {p.x(), p.y(), z}; }

// Where the fingertip touches, in F: the forward kinematics alone decide.
Vector3d touchedPoint(const HandDescription& hand, const HandConfiguration& found, int finger) {
  const HandGeometry geometry = forwardKinematics(hand, found.joints);
  return found.X_FP * geometry.tips_P[finger] + hand.tip_radius * raised(found.push_F[finger], 0);
}

std::size_t stepsAccountedFor(const Configurations& found) {
  std::size_t sum = found.configurations.size() + found.merged;
  for (const std::size_t n : found.rejected) sum += n;
  return sum;
}

// How exactly the points are met: where those of F1 and F2 are as good as mirror images in the thumb's line
// of push, the hands of the sweep share out what is missing.
double placement(const Triplet& triplet, const HandConfiguration& found) {
  const Vector2d &thumb = triplet.points_F[found.point_of_finger[kThumb]], h = found.push_F[kThumb];
  const Vector2d p1 = triplet.points_F[found.point_of_finger[kF1]] - thumb;
  const Vector2d p2 = triplet.points_F[found.point_of_finger[kF2]] - thumb;
  const bool symmetric = std::abs(cross(p1, h) + cross(p2, h)) < tolerance::kSymmetricFingers &&
                         std::abs(p1.dot(h) - p2.dot(h)) < tolerance::kSymmetricFingers;
  return symmetric ? 0.0004 : 1e-9;
}

// What every configuration must satisfy, whoever asks.
void expectReaches(const HandDescription& hand, const Triplet& triplet, const HandConfiguration& found,
                   const ConfigurationOptions& options, double in_plane) {
  for (int finger = 0; finger < 3; ++finger) {
    const int point = found.point_of_finger[finger];
    const Vector3d touched = touchedPoint(hand, found, finger);
    EXPECT_LT((touched.head<2>() - triplet.points_F[point]).norm(), in_plane) << "finger " << finger;
    EXPECT_NEAR(touched.z(), found.depth_m[finger], 1e-12);
    EXPECT_GE(found.depth_m[finger], triplet.nearest_depth_m[point] - options.depth_tolerance_m - 1e-12);
    EXPECT_LE(found.depth_m[finger], triplet.farthest_depth_m[point] + options.depth_tolerance_m + 1e-12);
    EXPECT_GE(found.push_F[finger].dot(triplet.normals_F[point]), std::cos(kCone) - 1e-12)
        << "outside the cone";
    EXPECT_NEAR(extension(hand, found.joints.inner[finger]), found.extension_m[finger], 1e-12);
    EXPECT_NEAR(tipHeight(hand, found.joints.inner[finger]), found.tip_height_m[finger], 1e-12);
    // A finger pushes from its fingertip towards its spread axis.
    const Vector2d outwards = fingerDirection(static_cast<Finger>(finger), found.joints.spread);
    EXPECT_LT((found.X_FP.linear() * raised(outwards, 0) + raised(found.push_F[finger], 0)).norm(), 1e-12);
  }
  EXPECT_LE(-found.X_FP.translation().z(), 1.0);
  EXPECT_GE(-found.X_FP.translation().z(), options.palm_clearance_m - 1e-12);
  EXPECT_LT((found.X_FP.linear().col(2) - Vector3d::UnitZ()).norm(), 1e-12)
      << "the palm does not look into the face";
  EXPECT_NEAR(found.X_FP.linear().determinant(), 1.0, 1e-12);
  const Vector2d thumb_normal = triplet.normals_F[found.point_of_finger[kThumb]];
  EXPECT_LT((turned(thumb_normal, found.thumb_angle) - found.push_F[kThumb]).norm(), 1e-12);
}

TEST(FindConfigurations, ForwardKinematicsPutTheFingertipsOntoThePoints) {
  std::mt19937_64 random(1);
  std::size_t exact = 0;
  for (const HandDescription& hand :
       {barrettHand(), readHandDescription(BOXGRASP_SOURCE_DIR "/deploy/hands/barrett_graspit.toml")}) {
    for (int trial = 0; trial < 100; ++trial) {
      const KnownGrasp grasp = test::randomGrasp(hand, random, kCone);
      const Configurations found = findConfigurations(hand, grasp.triplet, 17, keepingAll());
      EXPECT_GE(stepsAccountedFor(found), 300u) << "three thumbs, a hundred steps each, and sweeps";
      for (const HandConfiguration& configuration : found.configurations) {
        EXPECT_EQ(configuration.triplet, 17);
        const double in_plane = placement(grasp.triplet, configuration);
        expectReaches(hand, grasp.triplet, configuration, keepingAll(), in_plane);
        exact += in_plane == 1e-9;
      }
    }
  }
  EXPECT_GT(exact, 1000u);
}

// The hand that made a triplet is among those found, when the thumb angle is one of the steps.
TEST(FindConfigurations, FindsTheHandThatMadeTheTriplet) {
  std::mt19937_64 random(2);
  const HandDescription& hand = barrettHand();
  ConfigurationOptions options = keepingAll();
  options.thumb_steps = 1;  // the thumb pushes straight
  for (int trial = 0; trial < 1000; ++trial) {
    KnownGrasp grasp = test::randomGrasp(hand, random, 0.99 * kCone);
    grasp.triplet.normals_F[2] = turned(grasp.triplet.normals_F[2], grasp.thumb_angle);
    const auto found = findConfigurations(hand, grasp.triplet, 0, options).configurations;
    const bool there = std::any_of(found.begin(), found.end(), [&](const HandConfiguration& c) {
      return c.point_of_finger == std::array{0, 1, 2} && std::abs(c.joints.spread - grasp.spread) < 1e-6 &&
             std::abs(c.extension_m[2] - grasp.extension_m[2]) < 1e-6;
    });
    EXPECT_TRUE(there) << "trial " << trial << ", spread " << grasp.spread;
  }
}

// A hand as the search below finds it.
struct BruteForceHand {
  std::array<int, 3> point_of_finger;
  int step;
  double thumb_reach, spread;
};

// Searches by brute force, with none of the closed form's algebra: for every assignment, every thumb angle
// and every place of the palm along the thumb's line, the directions from both spread axes to their points
// give a spread each. Where their difference changes its sign between two places there is a hand in between,
// pinned down by bisection.
class BruteForce {
 public:
  BruteForce(const HandDescription& hand, const Triplet& triplet, int steps)
      : hand_(hand), triplet_(triplet), steps_(steps), reach_(fingerReach(hand)) {}

  std::vector<BruteForceHand> search() {
    for (const auto& order : {std::array{0, 1, 2}, {1, 0, 2}, {0, 2, 1}, {2, 0, 1}, {1, 2, 0}, {2, 1, 0}}) {
      for (int step = 0; step < steps_; ++step) scanPlaces(order, step);
    }
    return found_;
  }

 private:
  void scanPlaces(const std::array<int, 3>& order, int step) {
    order_ = order;
    const double angle = -kCone + (step + 0.5) * 2 * kCone / steps_;
    h_ = turned(triplet_.normals_F[order[2]], angle);
    constexpr double kStep_m = 0.001;
    const double from = hand_.base_radius + reach_.extension_min_m,
                 to = hand_.base_radius + reach_.extension_max_m;
    for (double s = from; s < to; s += kStep_m) {
      double low = s, high = std::min(s + kStep_m, to);
      if ((gap(low) < 0) == (gap(high) < 0)) continue;
      const bool rising = gap(low) < 0;
      for (int i = 0; i < 60; ++i)
        ((gap(0.5 * (low + high)) < 0) == rising ? low : high) = 0.5 * (low + high);
      if (std::abs(gap(low)) < 1e-6 && fits(low)) found_.push_back({order_, step, low, spreads(low).first});
    }
  }

  // From the palm's origin at s along h: the vector from a spread axis to the finger's point, in hand
  // coordinates.
  Vector2d fromAxis(int finger, double s) const {
    const Vector2d origin = triplet_.points_F[order_[2]] + s * h_, k = turned(h_, -std::numbers::pi / 2);
    const Vector2d axis = origin + (finger == 0 ? 1 : -1) * hand_.spread_offset * k;
    const Vector2d p = triplet_.points_F[order_[finger]] - axis;
    return {p.dot(k), p.dot(h_)};
  }
  std::pair<double, double> spreads(double s) const {
    const Vector2d p1 = fromAxis(0, s), p2 = fromAxis(1, s);
    return {std::atan2(p1.x(), p1.y()), std::atan2(-p2.x(), p2.y())};
  }
  double gap(double s) const { return spreads(s).first - spreads(s).second; }

  // With some air to every bound, so that rounding decides nothing.
  bool fits(double s) const {
    constexpr double kAir = 1e-6;
    const double spread = spreads(s).first;
    if (spread < kAir || spread > std::numbers::pi - kAir) return false;
    for (int finger = 0; finger < 2; ++finger) {
      const Vector2d p = fromAxis(finger, s), k = turned(h_, -std::numbers::pi / 2);
      const double e = p.norm() - hand_.base_radius;
      if (e < reach_.extension_min_m + kAir || e > reach_.extension_max_m - kAir) return false;
      const Vector2d push = -(p.x() * k + p.y() * h_).normalized();
      if (std::acos(push.dot(triplet_.normals_F[order_[finger]])) > kCone - kAir) return false;
    }
    return true;
  }

  const HandDescription& hand_;
  const Triplet& triplet_;
  int steps_;
  Reach reach_;
  std::array<int, 3> order_{};
  Vector2d h_{0, 0};
  std::vector<BruteForceHand> found_;
};

TEST(FindConfigurations, BruteForceFindsNoOther) {
  std::mt19937_64 random(3);
  const HandDescription& hand = barrettHand();
  ConfigurationOptions options = keepingAll();
  options.thumb_steps = 20;
  options.depth_tolerance_m = 1.0;  // any depth will do: the search is in the plane
  std::size_t found_by_brute_force = 0, found_in_closed_form = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const KnownGrasp grasp = test::randomGrasp(hand, random, kCone);
    const auto found = findConfigurations(hand, grasp.triplet, 0, options).configurations;
    const auto expected = BruteForce(hand, grasp.triplet, options.thumb_steps).search();
    for (const BruteForceHand& e : expected) {
      const double angle = -kCone + (e.step + 0.5) * 2 * kCone / options.thumb_steps;
      const bool there = std::any_of(found.begin(), found.end(), [&](const HandConfiguration& c) {
        return c.point_of_finger == e.point_of_finger && std::abs(c.thumb_angle - angle) < 1e-9 &&
               std::abs(c.joints.spread - e.spread) < 1e-5 &&
               std::abs(c.extension_m[2] + hand.base_radius - e.thumb_reach) < 1e-5;
      });
      EXPECT_TRUE(there) << "trial " << trial << ": no configuration for thumb angle " << angle
                         << " and spread " << e.spread;
    }
    found_by_brute_force += expected.size();
    found_in_closed_form += found.size();
  }
  EXPECT_GT(found_by_brute_force, 30u);
  EXPECT_NEAR(static_cast<double>(found_by_brute_force), static_cast<double>(found_in_closed_form),
              0.02 * static_cast<double>(found_in_closed_form))
      << "in the closed form " << found_in_closed_form;
}

// Definitions 1.0: the three lines of push always meet, on the thumb's axis.
TEST(FindConfigurations, TheLinesOfPushMeetInTheRealFocus) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 200; ++trial) {
    const KnownGrasp grasp = test::randomGrasp(barrettHand(), random, kCone);
    for (const HandConfiguration& c : findConfigurations(barrettHand(), grasp.triplet, 0).configurations) {
      for (int finger = 0; finger < 3; ++finger) {
        const Vector2d to_focus = c.real_focus_F - touchedPoint(barrettHand(), c, finger).head<2>();
        EXPECT_LT(std::abs(cross(c.push_F[finger], to_focus)), 1e-9 * (1.0 + to_focus.norm()))
            << "finger " << finger;
      }
    }
  }
}

// x -> -x. The hand has a left and a right finger, so they change places.
Triplet mirrored(Triplet triplet) {
  for (auto* vectors : {&triplet.points_F, &triplet.normals_F}) {
    for (Vector2d& v : *vectors) v.x() = -v.x();
  }
  return triplet;
}

bool isMirrorImage(const HandConfiguration& a, const HandConfiguration& b) {
  const Vector3d p = a.X_FP.translation(), q = b.X_FP.translation();
  return a.point_of_finger == std::array{b.point_of_finger[1], b.point_of_finger[0], b.point_of_finger[2]} &&
         std::abs(a.thumb_angle + b.thumb_angle) < 1e-12 &&
         std::abs(a.joints.spread - b.joints.spread) < 1e-9 &&
         std::abs(a.joints.inner[0] - b.joints.inner[1]) < 1e-7 &&
         std::abs(a.joints.inner[2] - b.joints.inner[2]) < 1e-7 &&
         (p - Vector3d(-q.x(), q.y(), q.z())).norm() < 1e-9;
}

TEST(FindConfigurations, AMirroredTripletGivesTheMirroredHands) {
  std::mt19937_64 random(5);
  for (const ConfigurationOptions& options : {keepingAll(), ConfigurationOptions{}}) {
    for (int trial = 0; trial < 100; ++trial) {
      const KnownGrasp grasp = test::randomGrasp(barrettHand(), random, kCone);
      const auto original = findConfigurations(barrettHand(), grasp.triplet, 0, options).configurations;
      const auto image =
          findConfigurations(barrettHand(), mirrored(grasp.triplet), 0, options).configurations;
      ASSERT_EQ(original.size(), image.size());
      for (std::size_t i = 0; i < original.size(); ++i)
        EXPECT_TRUE(isMirrorImage(original[i], image[i])) << "trial " << trial << ", configuration " << i;
    }
  }
}

// Turned and shifted in the plane of the face, the hands turn and shift with the points.
TEST(FindConfigurations, HandsMoveWithThePoints) {
  std::mt19937_64 random(6);
  for (int trial = 0; trial < 100; ++trial) {
    const KnownGrasp grasp = test::randomGrasp(barrettHand(), random, kCone);
    const double angle = uniform(random, -3, 3);
    const Vector2d shift(uniform(random), uniform(random));
    Triplet moved = grasp.triplet;
    for (Vector2d& p : moved.points_F) p = turned(p, angle) + shift;
    for (Vector2d& n : moved.normals_F) n = turned(n, angle);
    const auto before = findConfigurations(barrettHand(), grasp.triplet, 0).configurations;
    const auto after = findConfigurations(barrettHand(), moved, 0).configurations;
    ASSERT_EQ(before.size(), after.size());
    const Pose X = makePose(Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix(), raised(shift, 0));
    for (std::size_t i = 0; i < before.size(); ++i)
      EXPECT_TRUE((X * before[i].X_FP).isApprox(after[i].X_FP, 1e-7)) << "trial " << trial;
  }
}

// An isosceles triangle whose axis is the thumb's.
Triplet symmetricTriplet(double imbalance_m = 0.0) {
  Triplet triplet;
  triplet.points_F = {Vector2d(0.05, 0.02 + imbalance_m), Vector2d(-0.05 + imbalance_m, 0.02),
                      Vector2d(0, -0.04)};
  for (int i = 0; i < 3; ++i) triplet.normals_F[i] = -triplet.points_F[i].normalized();
  triplet.nearest_depth_m = {0, 0, 0};
  triplet.farthest_depth_m = {0.1, 0.1, 0.1};
  return triplet;
}

TEST(FindConfigurations, MirrorImagesUnderTheThumbFitARangeOfSpreads) {
  ConfigurationOptions options = keepingAll();
  options.thumb_steps = 101;  // the thumb pushing straight is one of them
  for (const double imbalance : {0.0, 0.0002}) {
    const Triplet triplet = symmetricTriplet(imbalance);
    double least = 10, greatest = 0;
    for (const HandConfiguration& c : findConfigurations(barrettHand(), triplet, 0, options).configurations) {
      if (c.point_of_finger[kThumb] != 2 || std::abs(c.thumb_angle) > 1e-9) continue;
      EXPECT_EQ(c.point_of_finger, (std::array{0, 1, 2}));
      expectReaches(barrettHand(), triplet, c, options, imbalance == 0 ? 1e-9 : 0.0004);
      least = std::min(least, c.joints.spread);
      greatest = std::max(greatest, c.joints.spread);
    }
    EXPECT_GT(greatest - least, 0.35)
        << "the friction cones of F1 and F2 leave 2 atan(0.4) of spread, less what is out "
           "of reach; imbalance "
        << imbalance;
  }
}

// The best height by brute force over all heights that are allowed.
TEST(FindConfigurations, ParallelFingersPinchWhatIsBetweenThemAndTheThumb) {
  const HandDescription& hand = barrettHand();
  std::mt19937_64 random(12);
  for (const double width : {0.006, 0.012, 0.05, 0.1}) {
    Triplet triplet;
    const double x = hand.spread_offset;
    triplet.points_F = {Vector2d(x, width), Vector2d(-x, width), Vector2d(0, 0)};
    triplet.normals_F = {Vector2d(0, -1), Vector2d(0, -1), Vector2d(0, 1)};
    triplet.nearest_depth_m = {0.0, 0.0, 0.0};
    triplet.farthest_depth_m = {0.01, 0.01, 0.01};
    const Eigen::Rotation2Dd turn(uniform(random, 0, 6.28));
    for (int i = 0; i < 3; ++i) {
      triplet.points_F[i] = turn * triplet.points_F[i];
      triplet.normals_F[i] = turn * triplet.normals_F[i];
    }
    const auto found = findConfigurations(hand, triplet, 0).configurations;
    const bool parallel = std::any_of(found.begin(), found.end(), [&](const HandConfiguration& one) {
      return one.joints.spread == 0.0 && std::abs(one.joints.inner[kF1] - one.joints.inner[kThumb]) < 0.02;
    });
    EXPECT_TRUE(parallel) << "no hand pinches " << 1e3 * width << " mm, all fingers closed alike";
    for (const HandConfiguration& one : found)
      expectReaches(hand, triplet, one, ConfigurationOptions{}, tolerance::kSymmetricFingers);
  }
}

TEST(FindConfigurations, ThePalmsHeightIsTheBest) {
  std::mt19937_64 random(7);
  const ConfigurationOptions options;
  std::size_t checked = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const Triplet triplet = test::randomGrasp(barrettHand(), random, kCone).triplet;
    for (const HandConfiguration& c : findConfigurations(barrettHand(), triplet, 0, options).configurations) {
      double best_cost = 1e9, best_height = NAN;
      for (double height = options.palm_clearance_m; height < 0.12; height += 1e-5) {
        double cost = 0.0;
        for (int finger = 0; finger < 3; ++finger) {
          const double nearest = triplet.nearest_depth_m[c.point_of_finger[finger]];
          const double farthest = triplet.farthest_depth_m[c.point_of_finger[finger]];
          const double depth = c.tip_height_m[finger] - height;
          const double aim = nearest + std::min(options.insertion_m, (farthest - nearest) / 2);
          const bool allowed =
              depth >= nearest - options.depth_tolerance_m && depth <= farthest + options.depth_tolerance_m;
          cost += allowed ? (depth - aim) * (depth - aim) : 1e6;
        }
        if (cost < best_cost) std::tie(best_cost, best_height) = std::pair(cost, height);
      }
      EXPECT_NEAR(-c.X_FP.translation().z(), best_height, 2e-5) << "trial " << trial;
      ++checked;
    }
  }
  EXPECT_GT(checked, 100u);
}

TEST(FindConfigurations, BelieveThePapersLineWhereTheyAreTold) {
  const HandDescription& hand = barrettHand();
  std::mt19937_64 random(21);
  ConfigurationOptions line = keepingAll();
  line.depth_model = DepthModel::linear;
  line.depth_tolerance_m = 1.0;  // any height will do: the planar solutions are the same ones
  std::size_t seen = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const KnownGrasp grasp = test::randomGrasp(hand, random, kCone);
    for (const HandConfiguration& found : findConfigurations(hand, grasp.triplet, 0, line).configurations) {
      for (int finger = 0; finger < 3; ++finger) {
        EXPECT_DOUBLE_EQ(found.tip_height_m[finger], linearDepth(hand, found.extension_m[finger]));
        EXPECT_LT((touchedPoint(hand, found, finger).head<2>() -
                   grasp.triplet.points_F[found.point_of_finger[finger]])
                      .norm(),
                  0.0005)
            << "in the plane the hand is the same";
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 100u);
}

TEST(FindConfigurations, MergesHandsThatHardlyDiffer) {
  std::mt19937_64 random(8);
  const ConfigurationOptions options;
  std::size_t all = 0, kept = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Triplet triplet = test::randomGrasp(barrettHand(), random, kCone).triplet;
    const auto every = findConfigurations(barrettHand(), triplet, 0, keepingAll()).configurations;
    const Configurations found = findConfigurations(barrettHand(), triplet, 0, options);
    EXPECT_GE(stepsAccountedFor(found), 300u);
    for (const HandConfiguration& c : every) {
      const bool represented =
          std::any_of(found.configurations.begin(), found.configurations.end(), [&](const auto& k) {
            return k.point_of_finger == c.point_of_finger &&
                   std::abs(k.thumb_angle - c.thumb_angle) < options.min_turn_rad &&
                   std::abs(k.joints.spread - c.joints.spread) < options.min_turn_rad;
          });
      EXPECT_TRUE(represented) << "trial " << trial << ", thumb angle " << c.thumb_angle;
    }
    if (!every.empty()) {
      EXPECT_EQ(found.configurations.front().thumb_angle, every.front().thumb_angle)
          << "the straightest thumb stays";
    }
    all += every.size();
    kept += found.configurations.size();
  }
  EXPECT_LT(3 * kept, all) << "merging saves clearance tests";
}

std::size_t rejected(const Configurations& found, ReachRejection reason) {
  return found.rejected[static_cast<std::size_t>(reason)];
}

TEST(FindConfigurations, EveryRejectionHasItsReason) {
  const auto scaledTriplet = [](double factor) {
    Triplet triplet = symmetricTriplet();
    for (Vector2d& p : triplet.points_F) p *= factor;
    return triplet;
  };
  const Configurations small = findConfigurations(barrettHand(), scaledTriplet(0.3), 0);
  EXPECT_TRUE(small.configurations.empty());
  EXPECT_EQ(rejected(small, ReachRejection::spread_or_side), 300u)
      << "F1 and F2 cannot come nearer than 50 mm";

  const Configurations large = findConfigurations(barrettHand(), scaledTriplet(10), 0);
  EXPECT_TRUE(large.configurations.empty());
  EXPECT_GT(rejected(large, ReachRejection::extension), 100u);

  Triplet turned_away = symmetricTriplet();
  turned_away.normals_F[0] = turned_away.normals_F[1] = Vector2d(0, 1);
  EXPECT_GT(rejected(findConfigurations(barrettHand(), turned_away, 0), ReachRejection::friction_cone), 0u);

  Triplet too_deep = symmetricTriplet();
  too_deep.nearest_depth_m = {0.2, 0.2, 0.2};
  too_deep.farthest_depth_m = {0.3, 0.3, 0.3};
  const Configurations deep = findConfigurations(barrettHand(), too_deep, 0);
  EXPECT_TRUE(deep.configurations.empty());
  EXPECT_GT(rejected(deep, ReachRejection::depth), 0u);

  Triplet uneven = symmetricTriplet();
  uneven.nearest_depth_m = {0.0, 0.0, 0.08};
  uneven.farthest_depth_m = {0.01, 0.01, 0.09};
  EXPECT_TRUE(findConfigurations(barrettHand(), uneven, 0).configurations.empty())
      << "the thumb's surface lies 80 mm deeper than the others': no height of the palm serves all three";
}

TEST(FindConfigurations, SurvivesDegenerateTriplets) {
  Triplet coincident;
  coincident.points_F = {Vector2d(0, 0), Vector2d(0, 0), Vector2d(0, 0)};
  coincident.normals_F = {Vector2d(1, 0), Vector2d(0, 1), Vector2d(-1, 0)};
  EXPECT_TRUE(findConfigurations(barrettHand(), coincident, 0).configurations.empty());
  Triplet not_a_number = coincident;
  not_a_number.points_F[1] = Vector2d(NAN, 0);
  EXPECT_TRUE(findConfigurations(barrettHand(), not_a_number, 0).configurations.empty());
}

TEST(ConfigurationOptions, NameTheBadField) {
  const auto complaint = [](auto change) -> std::string {
    ConfigurationOptions options;
    change(options);
    try {
      options.validate();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no complaint";
  };
  using ::testing::HasSubstr;
  EXPECT_EQ(complaint([](auto&) {}), "no complaint");
  EXPECT_THAT(complaint([](auto& o) { o.friction = -1; }), HasSubstr("friction' is -1"));
  EXPECT_THAT(complaint([](auto& o) { o.friction = NAN; }), HasSubstr("friction' is nan"));
  EXPECT_THAT(complaint([](auto& o) { o.thumb_steps = 0; }), HasSubstr("thumb_steps' is 0"));
  EXPECT_THAT(complaint([](auto& o) { o.insertion_m = -0.1; }), HasSubstr("insertion_m"));
  EXPECT_THAT(complaint([](auto& o) { o.min_turn_rad = 9; }), HasSubstr("min_turn_rad"));
}

}  // namespace
}  // namespace boxgrasp
