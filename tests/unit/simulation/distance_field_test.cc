#include "boxgrasp/simulation/distance_field.h"

#include <gtest/gtest.h>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/objects/parametric.h"
#include "boxgrasp/simulation/distance_samples.h"
#include "solids.h"

namespace boxgrasp {
namespace {

Vector3d randomPoint(std::mt19937_64& random, double half) {
  const double x = uniform(random, -half, half), y = uniform(random, -half, half);
  return {x, y, uniform(random, -half, half)};
}

double distanceToBox(const Vector3d& p, const Vector3d& half) {
  const Eigen::Array3d beyond = p.array().abs() - half.array();
  return beyond.max(0.0).matrix().norm() + std::min(0.0, beyond.maxCoeff());
}

double bruteForceDistance(const TriangleMesh& mesh, const Vector3d& p) {
  double nearest = INFINITY;
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::array corners{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
    nearest = std::min(nearest, (closestPoint(corners, p) - p).norm());
  }
  return nearest;
}

TEST(ClosestPoint, IsNoFartherThanAnyPointOfTheTriangle) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    const std::array corners{randomPoint(random, 1), randomPoint(random, 1), randomPoint(random, 1)};
    const Vector3d p = randomPoint(random, 2), nearest = closestPoint(corners, p);
    double sampled = INFINITY, off_plane = INFINITY;
    for (int j = 0; j <= 20; ++j) {
      for (int k = 0; k + j <= 20; ++k) {
        const Vector3d q = (j * corners[0] + k * corners[1] + (20 - j - k) * corners[2]) / 20;
        sampled = std::min(sampled, (q - p).norm());
        off_plane = std::min(off_plane, (q - nearest).norm());
      }
    }
    EXPECT_LE((nearest - p).norm(), sampled + 1e-12);
    EXPECT_LT(off_plane, 0.15) << "the point is not on the triangle";
  }
}

TEST(DistanceField, OfASphereIsThatOfTheFormula) {
  const DistanceField field(sphereMesh(0.04, 48));
  std::mt19937_64 random(2);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d direction = randomPoint(random, 1).normalized();
    const double distance = uniform(random, -0.01, 0.012);
    const FieldValue value = field.valueAndGradient((0.04 + distance) * direction);
    EXPECT_NEAR(value.distance, distance, 1.5e-4);
    EXPECT_GT(value.gradient_O.dot(direction), std::cos(0.08)) << "at distance " << distance;
  }
}

TEST(DistanceField, OfABoxIsExactAtItsFacesAndNearItsEdges) {
  const Vector3d sizes(0.05, 0.03, 0.07);
  const DistanceField field(boxMesh(sizes));
  std::mt19937_64 random(3);
  for (int i = 0; i < 5000; ++i) {
    const Vector3d p = randomPoint(random, 0.045);
    const double expected = distanceToBox(p, 0.5 * sizes);
    if (std::abs(expected) > 0.012) continue;
    EXPECT_NEAR(field.distance(p), expected, expected > 0.004 ? 3e-4 : 1.2e-3) << p.transpose();
  }
}

TEST(DistanceField, OfAThingWithThinWallsIsThatOfBruteForce) {
  const TriangleMesh mug = parametricObject("mug");
  const DistanceField field(mug);
  const Eigen::AlignedBox3d bounds = field.bounds();
  std::mt19937_64 random(4);
  int near = 0;
  for (int i = 0; i < 60; ++i) {
    const Vector3d p = bounds.center() + randomPoint(random, 0.5).cwiseProduct(bounds.sizes()) * 2.2;
    const double expected = bruteForceDistance(mug, p);
    if (expected > 0.014) continue;
    ++near;
    EXPECT_NEAR(std::abs(field.distance(p)), expected, 1e-3) << p.transpose();
  }
  EXPECT_GT(near, 5);
}

TEST(DistanceField, FarAwayGivesALowerBoundAndNoDirection) {
  const DistanceField field(boxMesh({0.05, 0.05, 0.05}));
  const FieldValue value = field.valueAndGradient({1.0, 0, 0});
  EXPECT_DOUBLE_EQ(value.distance, 0.975);
  EXPECT_TRUE(value.gradient_O.isZero());
}

TEST(DistanceField, GrowsItsCellsForLargeObjects) {
  const DistanceField field(boxMesh({1, 1, 1}), {.max_samples = 100'000});
  EXPECT_GT(field.cell(), 0.02);
  EXPECT_NEAR(field.distance({0.51, 0, 0}), 0.01, 1e-3);
}

TEST(DistanceField, RefusesImpossibleOptions) {
  EXPECT_THROW(DistanceField(boxMesh({1, 1, 1}), {.cell_m = 0}), InputError);
}

}  // namespace
}  // namespace boxgrasp
