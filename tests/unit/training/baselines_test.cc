#include "boxgrasp/training/baselines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "boxgrasp/decomposition/decompose.h"
#include "boxgrasp/geometry/point_grid.h"
#include "boxgrasp/objects/parametric.h"
#include "error_of.h"

namespace boxgrasp {
namespace {

using ::testing::HasSubstr;

const TriangleMesh& duck() {
  static const TriangleMesh mesh = parametricObject("duck");
  return mesh;
}

const PointCloud& duckCloud() {
  static const PointCloud cloud = sampleSurface(duck(), 20'000, 1);
  return cloud;
}

std::vector<HypothesisRecord> approaches() {
  return approachHypotheses(barrettHand(), decompose(duckCloud()), duckCloud());
}

Vector3d approachOf(const HypothesisRecord& record) { return record.X_OP.linear().col(2); }

// The hand is nowhere at the object where its way begins: everything of it is behind every vertex.
void expectClearAtTheStart(const HypothesisRecord& record, const TriangleMesh& mesh) {
  const HandGeometry hand = forwardKinematics(barrettHand(), record.pregrasp);
  double front = -1e9, nearest = 1e9;
  for (const Capsule& link : hand.links)
    front = std::max({front, link.a.z() + link.radius, link.b.z() + link.radius});
  for (const Vector3d& p : mesh.vertices)
    nearest = std::min(nearest, approachOf(record).dot(p - record.X_OP.translation()));
  EXPECT_LE(front - record.approach_m, nearest) << "grasp " << record.index;
}

void expectSound(const HypothesisRecord& record) {
  const HandDescription& hand = barrettHand();
  EXPECT_TRUE((record.X_OP.linear() * record.X_OP.linear().transpose()).isIdentity(1e-12));
  EXPECT_GT(record.X_OP.linear().determinant(), 0);
  EXPECT_GE(record.pregrasp.spread, hand.spread_min);
  EXPECT_LE(record.pregrasp.spread, hand.spread_max);
  EXPECT_EQ(record.pregrasp.inner, (std::array<double, 3>{hand.inner_min, hand.inner_min, hand.inner_min}));
  for (const double q : record.quality) EXPECT_TRUE(std::isnan(q)) << "nothing was planned";
}

TEST(FingerReachHeight, IsTheHighestPointOfAClosingFinger) {
  const HandDescription& hand = barrettHand();
  double highest = 0;
  for (double inner = hand.inner_min; inner <= hand.inner_max; inner += 1e-3)
    highest = std::max(highest, forwardKinematics(hand, {0, {inner, 0, 0}}).tips_P[0].z());
  EXPECT_NEAR(fingerReachHeight(hand), highest + hand.tip_radius, 1e-5);
}

TEST(RandomHypotheses, FaceTheSurfaceFromWithinReach) {
  const PointGrid grid(duckCloud(), 0.01);
  for (const HypothesisRecord& record : randomHypotheses(barrettHand(), duck(), 300, 7)) {
    expectSound(record);
    expectClearAtTheStart(record, duck());
    EXPECT_EQ(record.source, GraspSource::random);
    bool meets = false;  // a line from the palm along z meets the surface before the fingers end
    for (double way = 0; way <= fingerReachHeight(barrettHand()) && !meets; way += 0.001) {
      meets = grid.nearest(record.X_OP.translation() + way * approachOf(record), 0.003).has_value();
    }
    EXPECT_TRUE(meets) << "grasp " << record.index;
  }
}

TEST(RandomHypotheses, ComeFromEverywhereInEveryRollAndSpread) {
  const auto records = randomHypotheses(barrettHand(), duck(), 4000, 3);
  Matrix3d second_moment = Matrix3d::Zero();
  Vector3d mean_approach = Vector3d::Zero(), mean_x = Vector3d::Zero();
  double mean_spread = 0;
  for (const HypothesisRecord& record : records) {
    second_moment += approachOf(record) * approachOf(record).transpose() / 4000;
    mean_approach += approachOf(record) / 4000;
    mean_x += record.X_OP.linear().col(0) / 4000;
    mean_spread += record.pregrasp.spread / 4000;
  }
  // A closed surface has as much area before it as behind it, so no direction is preferred; only flat
  // objects would be approached rather across. Standard deviations of the means are below 0.01.
  EXPECT_LT(mean_approach.norm(), 0.04);
  EXPECT_LT(mean_x.norm(), 0.04);
  EXPECT_TRUE(second_moment.isApprox(Matrix3d::Identity() / 3, 0.15)) << second_moment;
  EXPECT_NEAR(mean_spread, std::numbers::pi / 2, 0.06);
}

TEST(RandomHypotheses, LongerListBeginsWithTheShorterAndSeedsDiffer) {
  const auto few = randomHypotheses(barrettHand(), duck(), 10, 5),
             many = randomHypotheses(barrettHand(), duck(), 30, 5),
             others = randomHypotheses(barrettHand(), duck(), 10, 6);
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i].X_OP.matrix(), many[i].X_OP.matrix());
    EXPECT_EQ(few[i].pregrasp.spread, many[i].pregrasp.spread);
    EXPECT_NE(few[i].X_OP.matrix(), others[i].X_OP.matrix());
    EXPECT_EQ(few[i].index, static_cast<int>(i));
  }
}

TEST(RandomHypotheses, RefusesNegativeNumbersAndMeshesWithoutArea) {
  EXPECT_THAT(test::errorOf([] { randomHypotheses(barrettHand(), duck(), -1, 1); }), HasSubstr("-1"));
  EXPECT_THAT(test::errorOf([] { randomHypotheses(barrettHand(), {}, 1, 1); }), HasSubstr("area"));
}

// Eight for each face: the palm on the normal through the face's centre, every quarter turn once.
TEST(ApproachHypotheses, GoAlongFaceNormalsThroughTheMiddleOfLeafBoxes) {
  const BoxTree tree = decompose(duckCloud());
  const auto records = approaches();
  ASSERT_GE(records.size(), 16u);
  ASSERT_EQ(records.size() % 8, 0u);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const HypothesisRecord& record = records[i];
    expectSound(record);
    expectClearAtTheStart(record, duck());
    EXPECT_EQ(record.index, static_cast<int>(i));
    const BoxNode& node = tree.nodes[record.box];
    EXPECT_TRUE(node.leaf());
    const Vector3d outward = (record.face % 2 ? 1 : -1) * node.box.X_CB.linear().col(record.face / 2);
    EXPECT_TRUE(approachOf(record).isApprox(-outward, 1e-9));
    EXPECT_TRUE(record.X_OP.translation().isApprox(node.box.X_CB.translation(), 1e-9));
  }
  for (std::size_t i = 0; i < records.size(); i += 4) {
    const Matrix3d turn = records[i].X_OP.linear().transpose() * records[i + 1].X_OP.linear();
    EXPECT_TRUE(turn.isApprox(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ()).matrix(), 1e-9));
  }
}

// The hand comes down on it, backs up and closes around it.
TEST(ApproachHypotheses, CloseOnAHeart) {
  const TriangleMesh heart = parametricObject("heart");
  const SimulatedObject object = makeSimulatedObject(heart);
  const PointCloud cloud = sampleSurface(heart, 20'000, 1);
  TrialOptions options;
  options.last_stage = TrialStage::close;
  options.back_up_on_touch = true;
  int closed = 0, tried = 0;
  for (const HypothesisRecord& record : approachHypotheses(barrettHand(), decompose(cloud), cloud)) {
    const TrialResult result = runTrial(barrettHand(), object, trialInput(record), options);
    EXPECT_FALSE(result.touched.empty()) << "the way ends at the object: " << result.report;
    closed += result.contacts.size() >= 3;
    ++tried;
  }
  EXPECT_GE(tried, 16);
  EXPECT_GE(4 * closed, tried) << "of " << tried;
}

}  // namespace
}  // namespace boxgrasp
