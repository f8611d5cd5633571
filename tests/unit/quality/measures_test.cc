#include "boxgrasp/quality/measures.h"

#include <gtest/gtest.h>

#include <numbers>

#include "random_pose.h"

namespace boxgrasp {
namespace {

using std::numbers::pi;
using Points = std::array<Vector2d, 3>;

Vector2d direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

GraspGeometry randomGrasp(std::mt19937_64& random) {
  GraspGeometry grasp;
  const auto point = [&] { return Vector2d(uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1)); };
  for (int i = 0; i < 3; ++i) {
    grasp.points_F[i] = point();
    grasp.normals_F[i] = direction(uniform(random, -pi, pi));
    grasp.push_F[i] = direction(uniform(random, -pi, pi));
    grasp.extension_m[i] = uniform(random, -0.08, 0.1);
    grasp.tip_height_m[i] = uniform(random, 0.04, 0.1);
    grasp.surface_depth_m[i] = uniform(random, 0.0, 0.1);
    grasp.contacts_C[i] = Vector3d(point().x(), point().y(), point().x());
  }
  grasp.spread = uniform(random, 0, pi);
  grasp.focus_F = point();
  grasp.shape_centroid_F = point();
  grasp.root_center_C = Vector3d(0.01, 0.02, 0.03);
  return grasp;
}

// The grasp turned and shifted, in the plane and in space.
GraspGeometry moved(GraspGeometry grasp, const Eigen::Isometry2d& X, const Pose& Y) {
  for (int i = 0; i < 3; ++i) {
    grasp.points_F[i] = X * grasp.points_F[i];
    grasp.normals_F[i] = X.linear() * grasp.normals_F[i];
    grasp.push_F[i] = X.linear() * grasp.push_F[i];
    grasp.contacts_C[i] = Y * grasp.contacts_C[i];
  }
  grasp.focus_F = X * grasp.focus_F;
  grasp.shape_centroid_F = X * grasp.shape_centroid_F;
  grasp.root_center_C = Y * grasp.root_center_C;
  return grasp;
}

// Finger i becomes finger order[i].
GraspGeometry reordered(const GraspGeometry& grasp, const std::array<int, 3>& order) {
  GraspGeometry result = grasp;
  for (int i = 0; i < 3; ++i) {
    result.points_F[order[i]] = grasp.points_F[i];
    result.normals_F[order[i]] = grasp.normals_F[i];
    result.push_F[order[i]] = grasp.push_F[i];
    result.extension_m[order[i]] = grasp.extension_m[i];
    result.tip_height_m[order[i]] = grasp.tip_height_m[i];
    result.surface_depth_m[order[i]] = grasp.surface_depth_m[i];
    result.contacts_C[order[i]] = grasp.contacts_C[i];
  }
  return result;
}

GraspGeometry scaled(GraspGeometry grasp, double factor) {
  for (int i = 0; i < 3; ++i) {
    grasp.points_F[i] *= factor;
    grasp.extension_m[i] *= factor;
    grasp.tip_height_m[i] *= factor;
    grasp.surface_depth_m[i] *= factor;
    grasp.contacts_C[i] *= factor;
  }
  for (Vector2d* p : {&grasp.focus_F, &grasp.shape_centroid_F}) *p *= factor;
  grasp.root_center_C *= factor;
  return grasp;
}

void expectSame(const QualityMeasures& got, const QualityMeasures& expected, const char* why) {
  for (int q = 0; q < 9; ++q) EXPECT_NEAR(got[q], expected[q], 1e-12) << "q" << q + 1 << ": " << why;
}

class Measures : public ::testing::TestWithParam<DepthModel> {
 protected:
  QualityMeasures measure(const GraspGeometry& grasp) const {
    return qualityMeasures(grasp, barrettHand(), GetParam());
  }
  std::mt19937_64 random_{7};
};

TEST_P(Measures, DoNotChangeUnderRigidMotions) {
  for (int trial = 0; trial < 200; ++trial) {
    const GraspGeometry grasp = randomGrasp(random_);
    Eigen::Isometry2d X = Eigen::Isometry2d::Identity();
    X.rotate(uniform(random_, -pi, pi)).pretranslate(Vector2d(uniform(random_), uniform(random_)));
    expectSame(measure(moved(grasp, X, test::randomPose(random_))), measure(grasp), "a rigid motion");
  }
}

TEST_P(Measures, DoNotDependOnTheOrderOfFingers) {
  for (int trial = 0; trial < 200; ++trial) {
    const GraspGeometry grasp = randomGrasp(random_);
    for (const std::array<int, 3>& order : {std::array{1, 0, 2}, std::array{1, 2, 0}})
      expectSame(measure(reordered(grasp, order)), measure(grasp), "fingers in another order");
  }
}

// Areas and the squared depths grow with the square of the size, distances with the size, angles not at all.
// The linear depth model has a length of its own, the offset, and is left out.
TEST_P(Measures, ScaleAsTheirUnitsSay) {
  constexpr std::array<int, 9> kPower{2, 0, 0, 1, 0, 1, 1, 2, 1};
  for (int trial = 0; trial < 100; ++trial) {
    const GraspGeometry grasp = randomGrasp(random_);
    const QualityMeasures once = measure(grasp), thrice = measure(scaled(grasp, 3.0));
    for (int q = 0; q < 9; ++q) {
      if (q == 7 && GetParam() == DepthModel::linear) continue;
      EXPECT_NEAR(thrice[q], once[q] * std::pow(3.0, kPower[q]), 1e-12) << "q" << q + 1;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BothDepthModels, Measures, ::testing::Values(DepthModel::exact, DepthModel::linear));

TEST(GraspTriangleSize, IsTheArea) {
  EXPECT_DOUBLE_EQ(graspTriangleSize({Vector2d(0, 0), Vector2d(0.04, 0), Vector2d(0.01, 0.03)}), 0.0006);
  EXPECT_DOUBLE_EQ(graspTriangleSize({Vector2d(0.01, 0.03), Vector2d(0.04, 0), Vector2d(0, 0)}), 0.0006)
      << "clockwise too";
  EXPECT_NEAR(graspTriangleSize({Vector2d(0, 0), Vector2d(1, 1), Vector2d(2, 2)}), 0.0, 1e-15);
}

TEST(PointArrangement, RunsFromEquilateralToCollinear) {
  EXPECT_NEAR(pointArrangement({direction(0.3), direction(0.3 + 2 * pi / 3), direction(0.3 + 4 * pi / 3)}),
              0.0, 1e-12);
  EXPECT_NEAR(pointArrangement({Vector2d(0, 0), Vector2d(1, 0.5), Vector2d(3, 1.5)}), 1.0, 1e-9)
      << "collinear";
  // 90, 45 and 45 degrees: 30 + 15 + 15 of 240.
  EXPECT_NEAR(pointArrangement({Vector2d(0, 0), Vector2d(1, 0), Vector2d(0, 1)}), 0.25, 1e-12);
}

TEST(PointArrangement, GrowsAsATriangleFlattens) {
  double last = 0.0;
  for (double height = std::sqrt(3.0) - 0.05; height > 0; height -= 0.05) {
    const double q2 = pointArrangement({Vector2d(-1, 0), Vector2d(1, 0), Vector2d(0, height)});
    EXPECT_GT(q2, last) << "at height " << height;
    EXPECT_LE(q2, 1.0);
    last = q2;
  }
}

TEST(ForceLine, SumsTheAnglesBetweenPushAndNormal) {
  const Points normals{direction(0.1), direction(2.0), direction(-3.1)};
  EXPECT_DOUBLE_EQ(forceLine(normals, normals), 0.0);
  EXPECT_NEAR(forceLine({direction(0.3), direction(1.9), direction(-3.1)}, normals), 0.3, 1e-12);
  EXPECT_NEAR(forceLine({-normals[0], normals[1], normals[2]}, normals), pi, 1e-12)
      << "a push straight outwards";
}

TEST(FingerExtension, IsTheMean) { EXPECT_DOUBLE_EQ(fingerExtension({0.03, -0.01, 0.01}), 0.01); }

TEST(FingerSpread, IsLeastWhereTheFingersStandEvenly) {
  EXPECT_DOUBLE_EQ(fingerSpread(pi / 3), 0.0);
  EXPECT_DOUBLE_EQ(fingerSpread(0.0), pi / 3);
  EXPECT_DOUBLE_EQ(fingerSpread(pi), 2 * pi / 3);
}

// 0 exactly when all lines of push pass through the focus; a focus moved across one line counts by its
// distance from it.
TEST(FocusDeviation, SumsTheDistancesFromTheLinesOfPush) {
  const Points points{Vector2d(0.05, 0.02), Vector2d(-0.05, 0.02), Vector2d(0, -0.04)};
  const Vector2d focus(0.003, 0.001);
  Points push;
  for (int i = 0; i < 3; ++i) push[i] = (focus - points[i]).normalized();
  EXPECT_NEAR(focusDeviation(points, push, focus), 0.0, 1e-17);
  EXPECT_NEAR(focusDeviation({Vector2d(-1, 0), Vector2d(1, 0), Vector2d(0, -1)},
                             {Vector2d(1, 0), Vector2d(-1, 0), Vector2d(0, 1)}, {0.02, 0.03}),
              0.03 + 0.03 + 0.02, 1e-15);
}

TEST(ForceFocus, IsTheDistanceFromTheCentre) {
  EXPECT_DOUBLE_EQ(forceFocus2d({0.03, 0.04}, {0, 0}), 0.05);
  EXPECT_DOUBLE_EQ(forceFocus3d({Vector3d(0, 0, 3), Vector3d(0, 6, 0), Vector3d(6, 0, 0)}, {2, 2, 0}), 1.0);
}

TEST(FingerDepthDifference, LinearIsEquation4ToTheLetter) {
  GraspGeometry grasp;
  grasp.points_F = {Vector2d(0, 0), Vector2d(1, 0), Vector2d(0, 1)};
  grasp.normals_F = grasp.push_F = {Vector2d(1, 0), Vector2d(1, 0), Vector2d(1, 0)};
  grasp.contacts_C = {Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  grasp.focus_F = grasp.shape_centroid_F = Vector2d::Zero();
  grasp.root_center_C = Vector3d::Zero();
  grasp.tip_height_m = {9, 9, 9};  // must not matter
  grasp.extension_m = {-0.030, 0.010, -0.055};
  grasp.surface_depth_m = {0.080, 0.120, 0.070};
  double expected_mm2 = 0.0;
  for (const auto& [e, d] : {std::pair{-30.0, 80.0}, {10.0, 120.0}, {-55.0, 70.0}})
    expected_mm2 += std::pow(0.953 * e + 128.8 - d, 2);
  EXPECT_NEAR(1e6 * qualityMeasures(grasp, barrettHand(), DepthModel::linear)[7], expected_mm2, 1e-9);
}

// The exact model is what Eq. 4 gives at the best stand-off: no shift of the hand makes it smaller.
TEST(FingerDepthDifference, ExactIsTheLeastOverAllStandOffs) {
  const std::array<double, 3> reached{0.09, 0.07, 0.08}, surface{0.01, 0.02, 0.005};
  const double exact = fingerDepthDifference(reached, surface, DepthModel::exact);
  double least = 1.0;
  for (double stand_off = 0.0; stand_off < 0.1; stand_off += 1e-5) {
    const std::array<double, 3> shifted{reached[0] - stand_off, reached[1] - stand_off,
                                        reached[2] - stand_off};
    least = std::min(least, fingerDepthDifference(shifted, surface, DepthModel::linear));
    EXPECT_NEAR(fingerDepthDifference(shifted, surface, DepthModel::exact), exact, 1e-15)
        << "stand-off " << stand_off;
  }
  EXPECT_NEAR(exact, least, 1e-9);
  EXPECT_LE(exact, least);
}

TEST(QualityMeasures, ComeInTheOrderOfThePaper) {
  std::mt19937_64 random(3);
  const GraspGeometry g = randomGrasp(random);
  const QualityMeasures q = qualityMeasures(g, barrettHand());
  const QualityMeasures expected{graspTriangleSize(g.points_F),
                                 pointArrangement(g.points_F),
                                 forceLine(g.push_F, g.normals_F),
                                 fingerExtension(g.extension_m),
                                 fingerSpread(g.spread),
                                 focusDeviation(g.points_F, g.push_F, g.focus_F),
                                 forceFocus2d(g.focus_F, g.shape_centroid_F),
                                 fingerDepthDifference(g.tip_height_m, g.surface_depth_m, DepthModel::exact),
                                 forceFocus3d(g.contacts_C, g.root_center_C)};
  EXPECT_EQ(q, expected);
}

}  // namespace
}  // namespace boxgrasp
