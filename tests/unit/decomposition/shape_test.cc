#include "boxgrasp/decomposition/shape.h"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "boxgrasp/base/error.h"
#include "shapes.h"

namespace boxgrasp {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

struct Solid {
  ShapeKind kind;
  Vector3d extents;  // of its box: twice the radius across
};

Vector3d onSphere(const Solid& solid, std::mt19937_64& random) {
  return 0.5 * solid.extents.x() * Vector3d(normal(random), normal(random), normal(random)).normalized();
}

// On the side or the ends of a cylinder along z, as their areas are.
Vector3d onCylinder(const Solid& solid, std::mt19937_64& random) {
  const double r = 0.5 * solid.extents.x(), h = solid.extents.z(), turn = uniform(random, 0, kTwoPi);
  const bool side = uniform(random) < h / (h + r);
  const double at = side ? r : r * std::sqrt(uniform(random));
  const double z = side ? uniform(random, -0.5, 0.5) * h : (uniform(random) < 0.5 ? -0.5 : 0.5) * h;
  return {at * std::cos(turn), at * std::sin(turn), z};
}

Vector3d onBox(const Solid& solid, std::mt19937_64& random) {
  const Vector3d& e = solid.extents;
  const double areas[3] = {e.y() * e.z(), e.z() * e.x(), e.x() * e.y()};
  double at = uniform(random, 0, areas[0] + areas[1] + areas[2]);
  int axis = 0;
  while (axis < 2 && at > areas[axis]) at -= areas[axis++];
  Vector3d p;
  for (int i = 0; i < 3; ++i) p[i] = uniform(random, -0.5, 0.5) * e[i];
  p[axis] = (uniform(random) < 0.5 ? -0.5 : 0.5) * e[axis];
  return p;
}

Vector3d onSurface(const Solid& solid, std::mt19937_64& random) {
  if (solid.kind == ShapeKind::sphere) return onSphere(solid, random);
  return solid.kind == ShapeKind::cylinder ? onCylinder(solid, random) : onBox(solid, random);
}

std::vector<std::uint32_t> allOf(const PointCloud& cloud) {
  std::vector<std::uint32_t> all(cloud.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

// A cloud of the solid in pose X_CB with its true box, and the shape that is told of it.
struct Told {
  BoxShape shape;
  Pose X_CB;
};
Told told(const Solid& solid, std::mt19937_64& random, std::size_t n, double noise_m = 0.0,
          std::size_t strays = 0, const std::function<bool(const Vector3d&)>& seen = {}) {
  const Pose X_CB = test::randomPose(random);
  PointCloud cloud;
  while (cloud.size() < n) {
    const Vector3d p = onSurface(solid, random);
    if (seen && !seen(p)) continue;
    cloud.push(X_CB * (p + noise_m * Vector3d(normal(random), normal(random), normal(random))));
  }
  for (std::size_t i = 0; i < strays; ++i) {
    const Vector3d share(uniform(random, -0.5, 0.5), uniform(random, -0.5, 0.5), uniform(random, -0.5, 0.5));
    cloud.push(X_CB * share.cwiseProduct(solid.extents));
  }
  return {shapeOf(cloud, allOf(cloud), {X_CB, solid.extents}), X_CB};
}

Solid randomSolid(ShapeKind kind, std::mt19937_64& random) {
  const double r = uniform(random, 0.015, 0.06);
  if (kind == ShapeKind::sphere) return {kind, Vector3d::Constant(2 * r)};
  if (kind == ShapeKind::cylinder) return {kind, {2 * r, 2 * r, uniform(random, 0.8, 6.0) * r}};
  return {kind, {2 * r, uniform(random, 1.0, 4.0) * r, uniform(random, 1.0, 6.0) * r}};
}

constexpr ShapeKind kKinds[] = {ShapeKind::box, ShapeKind::cylinder, ShapeKind::sphere};

TEST(Shape, EachSolidIsToldInAnyPoseWithItsSizeUnderNoiseAndStrays) {
  std::mt19937_64 random(1);
  for (const ShapeKind kind : kKinds) {
    for (int trial = 0; trial < 30; ++trial) {
      const Solid solid = randomSolid(kind, random);
      const auto [shape, X_CB] = told(solid, random, 3000, 0.0005, 40);
      ASSERT_EQ(describe(shape.kind), describe(kind)) << solid.extents.transpose();
      if (kind == ShapeKind::box) continue;
      EXPECT_NEAR(shape.radius_m, 0.5 * solid.extents.x(), 0.001);
      const Vector3d center_B = X_CB.inverse() * shape.center_C;
      EXPECT_LT(center_B.norm(), 0.0015);
      if (kind == ShapeKind::cylinder) {
        EXPECT_NEAR(std::abs(shape.axis_C.dot(X_CB.linear().col(2))), 1.0, 1e-9);
      }
    }
  }
}

// Nine points of ten on one half, and the other half hardly sampled at all.
TEST(Shape, UnevenSamplingMakesNoDifference) {
  std::mt19937_64 random(2);
  for (const ShapeKind kind : kKinds) {
    for (int trial = 0; trial < 10; ++trial) {
      std::mt19937_64 choice(trial);
      const Solid solid = randomSolid(kind, random);
      const auto found = told(solid, random, 4000, 0.0005, 0,
                              [&](const Vector3d& p) { return p.x() > 0 || uniform(choice) < 0.1; });
      EXPECT_EQ(describe(found.shape.kind), describe(kind)) << solid.extents.transpose();
    }
  }
}

// What one camera sees of a can is half of its side.
TEST(Shape, HalfACylinderIsStillOne) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const double r = uniform(random, 0.02, 0.05);
    PointCloud cloud;
    for (int i = 0; i < 2000; ++i) {
      const double turn = uniform(random, 0, std::numbers::pi);
      cloud.push(Vector3d(r * std::cos(turn), r * std::sin(turn), uniform(random, -0.05, 0.05)));
    }
    const OrientedBox box{makePose(Matrix3d::Identity(), {0, 0.5 * r, 0}), {2 * r, r, 0.1}};
    const BoxShape shape = shapeOf(cloud, allOf(cloud), box);
    EXPECT_EQ(describe(shape.kind), "cylinder") << r;
    EXPECT_NEAR(shape.radius_m, r, 0.001);
    EXPECT_LT(shape.center_C.head<2>().norm(), 0.001);
  }
}

TEST(Shape, TooFewPointsTellNothing) {
  std::mt19937_64 random(4);
  const auto found = told({ShapeKind::sphere, Vector3d::Constant(0.08)}, random, 40);
  EXPECT_EQ(found.shape.kind, ShapeKind::box);
  EXPECT_TRUE(std::isinf(found.shape.residual_m[2]));
}

TEST(Shape, DegenerateInputIsABox) {
  PointCloud one;
  for (int i = 0; i < 500; ++i) one.push(Vector3d(0.1, 0.2, 0.3));
  const OrientedBox box = boxAround(one, Matrix3d::Identity());
  EXPECT_EQ(shapeOf(one, allOf(one), box).kind, ShapeKind::box);
  EXPECT_EQ(shapeOf(one, {}, box).kind, ShapeKind::box);
}

TEST(Shape, BadOptionsAreRefused) {
  const PointCloud none;
  EXPECT_THROW(shapeOf(none, {}, {}, {.min_cells = 3}), InputError);
  EXPECT_THROW(shapeOf(none, {}, {}, {.max_residual_share = 0.0}), InputError);
  EXPECT_THROW(shapeOf(none, {}, {}, {.min_arc_rad = 7.0}), InputError);
}

}  // namespace
}  // namespace boxgrasp
