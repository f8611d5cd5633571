#include "boxgrasp/simulation/touch.h"

#include <gtest/gtest.h>

#include "boxgrasp/base/random.h"
#include "random_pose.h"
#include "solids.h"

namespace boxgrasp {
namespace {

const Vector3d kBox(0.06, 0.06, 0.06);

HandPart rod(const Vector3d& a, const Vector3d& b, double radius) {
  return linkPart({"rod", 0, a, b, radius});
}

TEST(Touches, OfARodOnAFaceAreItsEnds) {
  const DistanceField field(boxMesh(kBox));
  const HandPart part = rod({-0.02, 0, 0.0385}, {0.02, 0, 0.0385}, 0.009);
  const std::vector<Touch> found = touches(part, Pose::Identity(), field, 2);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(std::abs(found[0].p_O.x() - found[1].p_O.x()), 0.04, 0.021);
  for (const Touch& touch : found) {
    EXPECT_NEAR(touch.depth, 0.0005, 1e-5);
    EXPECT_NEAR(touch.p_O.z(), 0.03, 1e-5);
    EXPECT_GT(touch.normal_O.dot(-Vector3d::UnitZ()), 0.9999) << touch.normal_O.transpose();
  }
}

TEST(Touches, OfARodThatIsApartAreNone) {
  const DistanceField field(boxMesh(kBox));
  const HandPart part = rod({-0.02, 0, 0.0392}, {0.02, 0, 0.0392}, 0.009);
  EXPECT_TRUE(touches(part, Pose::Identity(), field, 3).empty());
  EXPECT_TRUE(touches(part, makePose(Matrix3d::Identity(), {0, 0, 1}), field, 3).empty());
}

// Moving hand and object together changes nothing.
TEST(Touches, DependOnTheRelativePoseAlone) {
  const DistanceField field(sphereMesh(0.04, 24));
  std::mt19937_64 random(1);
  for (int i = 0; i < 50; ++i) {
    const Pose X_AB = test::randomPose(random, 0.3);
    const HandPart part_A = rod({-0.03, 0.01, 0.047}, {0.03, 0.01, 0.049}, 0.009);
    const HandPart part_B = moved(part_A, X_AB.inverse());
    const auto expected = touches(part_A, Pose::Identity(), field, 3),
               found = touches(part_B, X_AB, field, 3);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) EXPECT_TRUE(found[k].p_O.isApprox(expected[k].p_O, 1e-6));
  }
}

TEST(Touches, OfThePalmUnderABoxStandOnItsCorners) {
  const DistanceField field(boxMesh(kBox));
  const Pose X_OP = makePose(Matrix3d::Identity(), {0, 0, -0.0295});
  const std::vector<Touch> found = touches(palmPart(barrettHand()), X_OP, field, 3);
  ASSERT_EQ(found.size(), 3u);
  for (const Touch& touch : found) EXPECT_NEAR(touch.depth, 0.0005, 1e-5);
  const Vector3d across = (found[1].p_O - found[0].p_O).cross(found[2].p_O - found[0].p_O);
  EXPECT_GT(0.5 * across.norm(), 0.02 * 0.02) << "three touches nearly on a line carry no face";
}

TEST(ClosestPoints, AreNoFartherApartThanAnyPair) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 300; ++i) {
    const auto point = [&] { return test::randomPose(random, 1.0).translation().eval(); };
    const Vector3d a1 = point(), b1 = point(), a2 = point(), b2 = i % 10 == 0 ? Vector3d(a2) : point();
    const SegmentPair pair = closestPoints(a1, b1, a2, b2);
    const double found = (pair.first - pair.second).norm();
    double sampled = INFINITY;
    for (int j = 0; j <= 100; ++j) {
      for (int k = 0; k <= 100; ++k) {
        sampled = std::min(sampled, (a1 + j / 100.0 * (b1 - a1) - a2 - k / 100.0 * (b2 - a2)).norm());
      }
    }
    EXPECT_LE(found, sampled + 1e-12);
    EXPECT_GT(found, sampled - 0.05) << "nearer than the segments are";
  }
}

}  // namespace
}  // namespace boxgrasp
