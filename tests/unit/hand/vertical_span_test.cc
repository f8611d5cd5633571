#include "boxgrasp/hand/vertical_span.h"

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

Vector3d randomPoint(std::mt19937_64& random) {
  return {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
}

// Along the line, exactly the span is inside: just within both ends yes, just beyond them no, and with no
// span no place of the line.
void expectExact(const Vector3d& a, const Vector3d& b, double radius, const Vector2d& line) {
  const auto inside = [&](double z, double slack) {
    return distanceFromSegment({line.x(), line.y(), z}, a, b) <= radius + slack;
  };
  const auto span = CapsuleSpans(a, b, radius).at(line);
  if (!span) {
    for (double z = -2; z < 2; z += 0.02) ASSERT_FALSE(inside(z, -1e-9)) << "missed the capsule at z " << z;
    return;
  }
  ASSERT_LE(span->low, span->high);
  for (int i = 0; i <= 20; ++i) ASSERT_TRUE(inside(std::lerp(span->low, span->high, i / 20.0), 1e-9));
  for (double beyond = 1e-5; beyond < 2; beyond *= 2) {
    ASSERT_FALSE(inside(span->low - beyond, -1e-12)) << "the span is too short below";
    ASSERT_FALSE(inside(span->high + beyond, -1e-12)) << "the span is too short above";
  }
}

TEST(CapsuleSpans, IsExactForCapsulesOfAnyDirection) {
  std::mt19937_64 random(1);
  int met = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const Vector3d a = randomPoint(random), b = randomPoint(random);
    const Vector2d line = randomPoint(random).head<2>();
    const double radius = uniform(random, 0.01, 0.5);
    expectExact(a, b, radius, line);
    met += CapsuleSpans(a, b, radius).at(line).has_value();
  }
  EXPECT_GT(met, 250);
}

TEST(CapsuleSpans, IsExactForUprightLyingAndPointLikeCapsules) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 500; ++trial) {
    const Vector3d a = randomPoint(random);
    const Vector2d line = a.head<2>() + 0.3 * randomPoint(random).head<2>();
    expectExact(a, a + Vector3d(0, 0, uniform(random, -1, 1)), 0.25, line);     // upright
    expectExact(a, a + Vector3d(1e-9, 0, uniform(random, -1, 1)), 0.25, line);  // as good as upright
    expectExact(a, a + Vector3d(0.5, uniform(random, -1, 1), 0), 0.25, line);   // lying
    expectExact(a, a, 0.25, line);                                              // a sphere
  }
}

TEST(CapsuleSpans, KnownValues) {
  const auto upright = CapsuleSpans({0, 0, 0}, {0, 0, 2}, 1).at({0, 0});
  ASSERT_TRUE(upright);
  EXPECT_DOUBLE_EQ(upright->low, -1);
  EXPECT_DOUBLE_EQ(upright->high, 3);
  const auto lying = CapsuleSpans({-2, 0, 5}, {2, 0, 5}, 1).at({1, 0.6});
  ASSERT_TRUE(lying);
  EXPECT_NEAR(lying->low, 4.2, 1e-12);
  EXPECT_NEAR(lying->high, 5.8, 1e-12);
  EXPECT_FALSE(CapsuleSpans({-2, 0, 5}, {2, 0, 5}, 1).at({1, 1.001}));
}

}  // namespace
}  // namespace boxgrasp
