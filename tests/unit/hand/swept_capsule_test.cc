#include "boxgrasp/hand/swept_capsule.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "random_pose.h"

namespace boxgrasp {
namespace {

double distanceFromSegment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const double length2 = (b - a).squaredNorm();
  const double along = length2 > 0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0.0;
  return (p - a - along * (b - a)).norm();
}

// The least distance of p from the segment on its way: it is convex in how far p is lifted.
double distanceOnTheWay(const Vector3d& p, const Vector3d& a, const Vector3d& b, double sweep_m) {
  const auto lifted = [&](double z) { return distanceFromSegment(p + z * Vector3d::UnitZ(), a, b); };
  double low = 0.0, high = sweep_m;
  for (int i = 0; i < 200; ++i) {
    const double third = (high - low) / 3;
    if (lifted(low + third) < lifted(high - third))
      high -= third;
    else
      low += third;
  }
  return std::min({lifted(low), lifted(0.0), lifted(sweep_m)});
}

Vector3d randomPoint(std::mt19937_64& random) {
  return {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
}

// Counts the points inside.
int expectExact(const Vector3d& a, const Vector3d& b, double radius, double sweep_m,
                std::mt19937_64& random) {
  int inside = 0;
  for (int i = 0; i < 20; ++i) {
    const Vector3d p = 2 * randomPoint(random);
    const double distance = distanceOnTheWay(p, a, b, sweep_m);
    if (std::abs(distance - radius) < 1e-7) continue;
    const bool contained = SweptCapsule(a, b, radius, sweep_m).contains(p);
    EXPECT_EQ(contained, distance < radius)
        << "the point (" << p.transpose() << ") comes to within " << distance << " of the segment from ("
        << a.transpose() << ") to (" << b.transpose() << ") on a way of " << sweep_m << "; the radius is "
        << radius;
    inside += contained;
  }
  return inside;
}

TEST(SweptCapsule, IsExactForSegmentsOfAnyDirection) {
  std::mt19937_64 random(1);
  int inside = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const double sweep_m = trial % 3 == 0 ? 0.0 : uniform(random, 0, 2);
    inside +=
        expectExact(randomPoint(random), randomPoint(random), uniform(random, 0.01, 0.9), sweep_m, random);
  }
  EXPECT_GT(inside, 1000) << "of 30000 points";
}

TEST(SweptCapsule, IsExactForUprightLyingAndPointLikeOnes) {
  std::mt19937_64 random(2);
  int inside = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Vector3d a = randomPoint(random);
    const double z = uniform(random, -1, 1);
    for (const double sweep_m : {0.0, 0.7}) {
      for (const Vector3d& along :
           {Vector3d(0, 0, z), Vector3d(1e-9, 0, z), Vector3d(0.5, z, 0), Vector3d(0, 0, 0)})
        inside += expectExact(a, a + along, 0.5, sweep_m, random);
    }
  }
  EXPECT_GT(inside, 1000);
}

TEST(SweptCapsule, KnownPlaces) {
  const SweptCapsule lying({-2, 0, 5}, {2, 0, 5}, 1, 3);
  EXPECT_TRUE(lying.contains({1, 0.6, 5.79})) << "just below its upper side";
  EXPECT_FALSE(lying.contains({1, 0.6, 5.81})) << "just above it";
  EXPECT_TRUE(lying.contains({1, 0.6, 1.21})) << "just above where its lower side comes from";
  EXPECT_FALSE(lying.contains({1, 0.6, 1.19})) << "just below that";
  EXPECT_FALSE(lying.contains({1, 1.001, 4})) << "beside it";
  const SweptCapsule upright({0, 0, 0}, {0, 0, 2}, 1, 0);
  EXPECT_TRUE(upright.contains({0, 0, 2.99}));
  EXPECT_FALSE(upright.contains({0, 0, 3.01}));
  EXPECT_FALSE(upright.contains({0, 0, -1.01}));
}

}  // namespace
}  // namespace boxgrasp
