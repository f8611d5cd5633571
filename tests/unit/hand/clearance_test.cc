#include "boxgrasp/hand/clearance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "boxgrasp/base/error.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

constexpr double kCell_m = 0.010;

double distanceFromSegment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  return (p - a - std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0) * (b - a)).norm();
}

HandJoints randomPosture(const HandDescription& hand, std::mt19937_64& random) {
  HandJoints joints{uniform(random, hand.spread_min, hand.spread_max), {}};
  for (double& inner : joints.inner) inner = uniform(random, 0.3, 1.9);
  return joints;
}

// The motion played step by step: the hand in every place on its way, and every link measured against every
// point.
class PlayedMotion {
 public:
  // `extra_m` makes all links thicker than they are: a little air decides the doubtful cases one way or the
  // other.
  PlayedMotion(const HandDescription& hand, const PointCloud& scene_P, const ClearanceOptions& options,
               double extra_m)
      : hand_(hand), scene_P_(scene_P), options_(options), extra_m_(extra_m) {}

  // Which opening is clear: its index, or -1.
  int firstClearOpening(const HandJoints& closed) const {
    if (meets(forwardKinematics(hand_, closed), 0.0, options_.contact_m)) return -1;
    for (std::size_t i = 0; i < options_.openings_rad.size(); ++i) {
      if (clear(opened(closed, options_.openings_rad[i]), closed)) return static_cast<int>(i);
    }
    return -1;
  }
  HandJoints opened(HandJoints joints, double opening) const {
    for (double& j : joints.inner)
      j = std::max(hand_.inner_min, std::min(opening, j - options_.min_opening_rad));
    return joints;
  }

 private:
  bool clear(const HandJoints& open, const HandJoints& closed) const {
    constexpr double kStep_m = 0.001;
    const HandGeometry coming = forwardKinematics(hand_, open);
    for (double back = 0.0; back < options_.approach_m + 1e-9; back += kStep_m) {
      if (meets(coming, back, options_.skin_m)) return false;
    }
    for (int step = 1; step <= options_.closing_steps; ++step) {
      HandJoints joints = closed;
      for (int i = 0; i < 3; ++i)
        joints.inner[i] += (open.inner[i] - closed.inner[i]) * (1 - step / (options_.closing_steps + 1.0));
      if (meets(forwardKinematics(hand_, joints), 0.0, options_.skin_m)) return false;
    }
    return true;
  }

  // The hand drawn back by `back` along its approach.
  bool meets(const HandGeometry& geometry, double back, double outer_thinning) const {
    for (std::size_t i = 0; i < scene_P_.size(); ++i) {
      const Vector3d p = scene_P_.point(i) + Vector3d(0, 0, back);
      for (int link = 0; link < 9; ++link) {
        const Capsule& capsule = geometry.links[link];
        const double thinning = link % 3 == 2 ? outer_thinning : options_.skin_m;
        if (distanceFromSegment(p, capsule.a, capsule.b) <= capsule.radius - thinning + extra_m_) return true;
      }
      const bool in_height =
          p.z() <= -options_.skin_m + extra_m_ && p.z() >= -hand_.palm_thickness - extra_m_;
      if (in_height && p.head<2>().norm() <= hand_.palm_radius - options_.skin_m + extra_m_) return true;
    }
    return false;
  }

  const HandDescription& hand_;
  const PointCloud& scene_P_;
  const ClearanceOptions& options_;
  double extra_m_;
};

// A few points about the hand: few enough that some hands get through.
PointCloud randomScene(std::mt19937_64& random, int n) {
  PointCloud scene_P;
  for (int i = 0; i < n; ++i)
    scene_P.push({uniform(random, -0.2, 0.2), uniform(random, -0.2, 0.2), uniform(random, -0.3, 0.15)});
  return scene_P;
}

TEST(TestClearance, AgreesWithTheMotionPlayedStepByStep) {
  std::mt19937_64 random(1);
  const HandDescription& hand = barrettHand();
  const ClearanceOptions options;
  int decided = 0, clear = 0, narrowed = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const HandJoints closed = randomPosture(hand, random);
    const PointCloud scene_P = randomScene(random, 1 + trial % 20);
    const Pose X_CP = test::randomPose(random);
    const int thicker = PlayedMotion(hand, scene_P, options, 0.0003).firstClearOpening(closed);
    const PlayedMotion thinner(hand, scene_P, options, -0.0003);
    const int expected = thinner.firstClearOpening(closed);
    if (thicker != expected)
      continue;  // a point within 0.3 mm of a link: steps of a millimetre cannot tell
    const PointCloud scene_C = transformed(scene_P, X_CP);
    const Clearance found = testClearance(hand, X_CP, closed, PointGrid(scene_C, kCell_m), options);
    ASSERT_EQ(found.pregrasp.has_value(), expected >= 0) << "trial " << trial;
    ASSERT_NE(found.pregrasp.has_value(), found.collision.has_value()) << "either a way in or what bars it";
    if (found.pregrasp) {
      EXPECT_EQ(found.pregrasp->inner, thinner.opened(closed, options.openings_rad[expected]).inner);
      EXPECT_EQ(found.pregrasp->spread, closed.spread) << "the spread is set before the approach";
    }
    ++decided;
    clear += expected >= 0;
    narrowed += expected > 0;
  }
  EXPECT_GT(decided, 300);
  EXPECT_GT(clear, 60);
  EXPECT_GT(decided - clear, 60);
  EXPECT_GT(narrowed, 3) << "some hands get in only with fingers less open";
}

// Columns along a shared approach direction answer as the plain test does, for hands turned and shifted on
// the face.
TEST(TestClearance, ColumnsAnswerAsTheGridDoes) {
  std::mt19937_64 random(2);
  const HandDescription& hand = barrettHand();
  for (int trial = 0; trial < 40; ++trial) {
    const Pose X_CA = test::randomPose(random);
    const PointCloud scene_C = transformed(randomScene(random, 8), X_CA);
    const PointGrid grid_C(scene_C, kCell_m);
    const Vector3d span(0.05, 0.05, 0.02);
    const ApproachColumns columns_A(grid_C, X_CA, reachableRegion(hand, {-span, span}));
    for (int i = 0; i < 20; ++i) {
      const Vector3d origin =
          span.cwiseProduct(Vector3d(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)));
      const Pose X_AP =
          makePose(Eigen::AngleAxisd(uniform(random, -3, 3), Vector3d::UnitZ()).toRotationMatrix(), origin);
      const HandJoints closed = randomPosture(hand, random);
      const Clearance by_grid = testClearance(hand, X_CA * X_AP, closed, grid_C);
      const Clearance by_columns = testClearance(hand, X_AP, closed, columns_A);
      ASSERT_EQ(by_grid.pregrasp.has_value(), by_columns.pregrasp.has_value()) << "trial " << trial;
      if (by_grid.pregrasp) {
        EXPECT_EQ(by_grid.pregrasp->inner, by_columns.pregrasp->inner);
      }
      if (by_grid.collision) {
        EXPECT_EQ(by_grid.collision->link, by_columns.collision->link);
        EXPECT_EQ(by_grid.collision->phase, by_columns.collision->phase);
      }
    }
  }
}

TEST(ReachableRegion, HoldsTheWholeHandOnItsWholeWay) {
  std::mt19937_64 random(3);
  const HandDescription& hand = barrettHand();
  const ClearanceOptions options;
  const Eigen::AlignedBox3d region = reachableRegion(hand, {Vector3d::Zero(), Vector3d::Zero()}, options);
  const Vector3d palm(hand.palm_radius, hand.palm_radius, 0);
  EXPECT_TRUE(region.contains(palm) && region.contains(-palm));
  EXPECT_TRUE(region.contains(Vector3d(0, 0, -hand.palm_thickness - options.approach_m)));
  for (int trial = 0; trial < 2000; ++trial) {
    HandJoints joints{uniform(random, 0, std::numbers::pi), {}};
    for (double& inner : joints.inner) inner = uniform(random, hand.inner_min, hand.inner_max);
    for (const Capsule& link : forwardKinematics(hand, joints).links) {
      for (const Vector3d& end : {link.a, link.b}) {
        const Vector3d around = Vector3d::Constant(link.radius), back(0, 0, -options.approach_m);
        EXPECT_TRUE(region.contains(end + around) && region.contains(end - around + back)) << link.name;
      }
    }
  }
}

// One point, and what it bars.
struct OnePoint {
  const char* what;
  Vector3d p_P;
  std::string_view link, phase;  // empty: nothing is met
};

TEST(TestClearance, NamesTheLinkAndThePhase) {
  const HandDescription& hand = barrettHand();
  const HandJoints closed{0.0, {1.2, 1.2, 1.2}};
  const HandGeometry place = forwardKinematics(hand, closed);
  const Vector3d f1_tip = place.tips_P[kF1], along_x = Vector3d::UnitX();
  const Capsule& thumb_inner = place.links[7];
  for (const OnePoint& c : {
           OnePoint{"before the palm, which comes through it", {0, 0.02, -0.05}, "palm", "approaching"},
           {"in front of the palm", {0, 0.02, 0.01}, "", ""},
           {"within the palm's skin", {0, 0.02, -0.002}, "", ""},
           {"behind where the hand starts", {0, 0.02, -0.24}, "", ""},
           {"in the middle of the inner link", 0.5 * (thumb_inner.a + thumb_inner.b), "thumb inner link",
            "in place"},
           {"in the fingertip", f1_tip, "F1 outer link", "in place"},
           {"at the fingertip's side, within what a contact may be off", f1_tip + 0.004 * along_x, "", ""},
           {"over the inner joint", {0.025, 0.05, -0.05}, "F1 knuckle", "approaching"},
       }) {
    PointCloud scene_P;
    scene_P.push(c.p_P);
    const PointGrid grid(scene_P, kCell_m);
    const Clearance found = testClearance(hand, Pose::Identity(), closed, grid);
    if (c.link.empty()) {
      EXPECT_TRUE(found.pregrasp) << c.what << ": " << found.collision->link;
      continue;
    }
    ASSERT_TRUE(found.collision) << c.what;
    EXPECT_EQ(found.collision->link, c.link) << c.what;
    EXPECT_EQ(found.collision->phase, c.phase) << c.what;
    EXPECT_LT((found.collision->p_C - c.p_P).norm(), 1e-6) << c.what;
    EXPECT_FALSE(found.pregrasp);
  }
}

// A ring of points that the widely open fingers hit on the way in, and the less open ones pass.
TEST(TestClearance, TakesTheWidestOpeningThatIsClear) {
  const HandDescription& hand = barrettHand();
  const HandJoints closed{1.0, {1.4, 1.4, 1.4}};
  PointCloud scene_P;
  EXPECT_EQ(testClearance(hand, Pose::Identity(), closed, PointGrid(scene_P, kCell_m)).pregrasp->inner,
            (std::array{0.0, 0.0, 0.0}))
      << "nothing in the way: open as wide as can be";
  for (double angle = 0; angle < 6.28; angle += 0.02)
    scene_P.push({0.15 * std::cos(angle), 0.15 * std::sin(angle), 0.0});
  const Clearance found = testClearance(hand, Pose::Identity(), closed, PointGrid(scene_P, kCell_m));
  ASSERT_TRUE(found.pregrasp) << found.collision->link << " " << found.collision->phase;
  EXPECT_GT(found.pregrasp->inner[0], 0.0);
}

// Fingers that are nearly open when closed cannot open by what is asked, and stop at their limit.
TEST(TestClearance, OpensEachFingerAtLeastByTheMinimumWithinItsLimits) {
  const PointCloud nothing;
  ClearanceOptions options;
  options.openings_rad = {0.7, 0.7, 0.7, 0.7};
  const HandJoints closed{0.5, {1.2, 0.75, 0.1}};
  const auto found =
      testClearance(barrettHand(), Pose::Identity(), closed, PointGrid(nothing, kCell_m), options);
  ASSERT_TRUE(found.pregrasp);
  EXPECT_DOUBLE_EQ(found.pregrasp->inner[0], 0.7);
  EXPECT_DOUBLE_EQ(found.pregrasp->inner[1], 0.6);
  EXPECT_DOUBLE_EQ(found.pregrasp->inner[2], 0.0);
}

// More points never clear the way, and thinner links never bar it.
TEST(TestClearance, IsMonotone) {
  std::mt19937_64 random(4);
  const HandDescription& hand = barrettHand();
  ClearanceOptions thin;
  thin.skin_m = thin.contact_m = 0.008;
  for (int trial = 0; trial < 300; ++trial) {
    const HandJoints closed = randomPosture(hand, random);
    PointCloud scene_P = randomScene(random, 6);
    const bool clear =
        testClearance(hand, Pose::Identity(), closed, PointGrid(scene_P, kCell_m)).pregrasp.has_value();
    if (clear) {
      EXPECT_TRUE(testClearance(hand, Pose::Identity(), closed, PointGrid(scene_P, kCell_m), thin).pregrasp);
    }
    for (int i = 0; i < 3; ++i) scene_P.push(randomScene(random, 1).point(0));
    if (!clear) {
      EXPECT_FALSE(testClearance(hand, Pose::Identity(), closed, PointGrid(scene_P, kCell_m)).pregrasp);
    }
  }
}

TEST(ApproachColumns, VisitsExactlyThePointsInTheHeightsAskedFor) {
  std::mt19937_64 random(5);
  const Pose X_CA = test::randomPose(random);
  const PointCloud scene_A = randomScene(random, 5000), scene_C = transformed(scene_A, X_CA);
  const Eigen::AlignedBox3d region(Vector3d(-0.15, -0.1, -0.2), Vector3d(0.1, 0.15, 0.1));
  const ApproachColumns columns(PointGrid(scene_C, kCell_m), X_CA, region);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector3d low(uniform(random, -0.2, 0.1), uniform(random, -0.2, 0.1), uniform(random, -0.3, 0));
    const Eigen::AlignedBox3d box(low, low + Vector3d(0.07, 0.06, 0.1));
    std::size_t inside = 0, expected = 0;
    columns.visit(box, [&](const Eigen::Vector3f& p) {
      EXPECT_TRUE(p.z() >= box.min().z() - 1e-6 && p.z() <= box.max().z() + 1e-6);
      inside += box.contains(p.cast<double>());
      return false;
    });
    for (std::size_t i = 0; i < scene_A.size(); ++i)
      expected += box.contains(scene_A.point(i)) && region.contains(scene_A.point(i));
    EXPECT_EQ(inside, expected);
  }
}

TEST(ApproachColumns, AnEmptySceneHasNothingToMeet) {
  const PointCloud nothing;
  const Eigen::AlignedBox3d region(Vector3d(-1, -1, -1), Vector3d(1, 1, 1));
  const ApproachColumns columns(PointGrid(nothing, kCell_m), Pose::Identity(), region);
  EXPECT_EQ(columns.size(), 0u);
  EXPECT_FALSE(columns.visit(region, [](const Eigen::Vector3f&) { return true; }));
}

TEST(ClearanceOptions, NameTheBadField) {
  using ::testing::HasSubstr;
  const auto complaint = [](auto change) -> std::string {
    ClearanceOptions options;
    change(options);
    try {
      options.validate();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no complaint";
  };
  EXPECT_EQ(complaint([](auto&) {}), "no complaint");
  EXPECT_THAT(complaint([](auto& o) { o.approach_m = -1; }), HasSubstr("approach_m' is -1"));
  EXPECT_THAT(complaint([](auto& o) { o.skin_m = NAN; }), HasSubstr("skin_m' is nan"));
  EXPECT_THAT(complaint([](auto& o) { o.openings_rad[2] = 7; }), HasSubstr("openings_rad' is 7"));
  EXPECT_THAT(complaint([](auto& o) { o.closing_steps = -1; }), HasSubstr("closing_steps"));
}

}  // namespace
}  // namespace boxgrasp
