// Convex bodies that meet and that do not, against closed forms.
#include "boxgrasp/geometry/separation.h"

#include <gtest/gtest.h>

#include "boxgrasp/base/random.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

constexpr double kMargin_m = 1e-4;

Vector3d randomPoint(std::mt19937_64& random) {
  return {uniform(random, -0.3, 0.3), uniform(random, -0.3, 0.3), uniform(random, -0.3, 0.3)};
}

Eigen::AlignedBox3d randomBox(std::mt19937_64& random) {
  Eigen::AlignedBox3d box(randomPoint(random));
  return box.extend(randomPoint(random));
}

// From a segment to a box: the least over a fine sampling, exact to `step` of the length.
double sampledDistance(const Vector3d& a, const Vector3d& b, const Eigen::AlignedBox3d& box) {
  double least = INFINITY;
  for (int i = 0; i <= 2000; ++i)
    least = std::min(least, box.exteriorDistance(Vector3d(a + i / 2000.0 * (b - a))));
  return least;
}

TEST(Apart, BallsAndBoxesByTheirDistance) {
  std::mt19937_64 random(1);
  int met = 0;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::AlignedBox3d box = randomBox(random);
    const Vector3d center = randomPoint(random);
    const double radius = uniform(random, 0.0, 0.2), gap = box.exteriorDistance(center) - radius;
    const bool found = apart(ballAround(center, radius), alignedBox(box), kMargin_m);
    met += gap < 0;
    if (gap > 0 && gap < 2 * kMargin_m) continue;
    EXPECT_EQ(found, gap > 0) << "a ball " << gap << " m away from the box";
  }
  EXPECT_GT(met, 1000);
  EXPECT_LT(met, 4000);
}

// A capsule is a ball that moved; a capsule that moved twice covers a slab.
TEST(Apart, SweptBodiesByTheirDistance) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::AlignedBox3d box = randomBox(random);
    const Vector3d a = randomPoint(random), b = randomPoint(random);
    const double radius = uniform(random, 0.0, 0.1), gap = sampledDistance(a, b, box) - radius;
    if (std::abs(gap) < 5e-4) continue;  // of the sampling's own error
    EXPECT_EQ(apart(capsuleBetween(a, b, radius), alignedBox(box)), gap > 0) << gap;
    EXPECT_EQ(apart(swept(ballAround(a, radius), b - a), alignedBox(box)), gap > 0) << gap;
  }
}

// A point of the body inside the other proves that they meet.
TEST(Apart, NeverSaysThatBodiesWithACommonPointAreApart) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d a = randomPoint(random), b = randomPoint(random), way = randomPoint(random);
    const Vector3d axis = (b - a).normalized();
    const double radius = uniform(random, 0.01, 0.1);
    const Vector3d p = a + uniform(random) * (b - a) + uniform(random) * way +
                       uniform(random) * radius * axis.unitOrthogonal();
    const Eigen::AlignedBox3d box(p - Vector3d(0.01, 0.02, 0.03), p + Vector3d(0.03, 0.01, 0.02));
    EXPECT_FALSE(apart(swept(cylinderBetween(a, b, radius), way), alignedBox(box)));
  }
}

TEST(Apart, ACylinderHasFlatEnds) {
  const Support cylinder = cylinderBetween({0, 0, -0.08}, {0, 0, 0}, 0.045);
  const auto above = [](double z) { return alignedBox({Vector3d(-1, -1, z), Vector3d(1, 1, z + 1)}); };
  EXPECT_TRUE(apart(cylinder, above(0.001)));
  EXPECT_FALSE(apart(cylinder, above(-0.001)));
  EXPECT_TRUE(apart(cylinder, alignedBox({Vector3d(0.046, -1, -1), Vector3d(1, 1, 1)})));
  EXPECT_FALSE(apart(cylinder, alignedBox({Vector3d(0.044, -1, -1), Vector3d(1, 1, 1)})));
}

}  // namespace
}  // namespace boxgrasp
