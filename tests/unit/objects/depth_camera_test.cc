#include "boxgrasp/objects/depth_camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "boxgrasp/base/error.h"
#include "boxgrasp/objects/polygonise.h"
#include "boxgrasp/objects/ray_caster.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

constexpr double kRadius = 0.05;

TriangleMesh ballAt(const Vector3d& center) {
  const Vector3d reach = Vector3d::Constant(kRadius + 0.01);
  return polygonise(sphere(center, kRadius), {center - reach, center + reach}, 0.003);
}

// A square across z, facing down the axis.
TriangleMesh wallAt(double z, double half_side) {
  TriangleMesh wall;
  wall.vertices = {{-half_side, -half_side, z},
                   {half_side, -half_side, z},
                   {half_side, half_side, z},
                   {-half_side, half_side, z}};
  wall.triangles = {{0, 2, 1}, {0, 3, 2}};
  return wall;
}

DepthCameraOptions small() {
  DepthCameraOptions options;
  options.width_px = 160;
  options.height_px = 120;
  options.focal_px = 144;
  return options;
}

std::size_t measured(const DepthView& view) {
  return static_cast<std::size_t>(
      std::count_if(view.depth_m.begin(), view.depth_m.end(), [](float z) { return !std::isnan(z); }));
}

struct Moments {
  double mean = 0, deviation = 0;
};
Moments momentsOf(const std::vector<float>& values) {
  double n = 0, sum = 0, squares = 0;
  for (const float value : values) {
    if (std::isnan(value)) continue;
    n += 1, sum += value, squares += static_cast<double>(value) * value;
  }
  return {sum / n, std::sqrt(squares / n - sum * sum / (n * n))};
}

// Brute force over all triangles.
double nearest(const TriangleMesh& mesh, const Vector3d& origin, const Vector3d& direction) {
  double best = INFINITY;
  for (const auto& t : mesh.triangles) {
    Matrix3d m;
    m << mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]], -direction;
    const Vector3d at = m.inverse() * (origin - mesh.vertices[t[0]]);
    if (at.allFinite() && at.minCoeff() >= 0 && at.x() + at.y() <= 1) best = std::min(best, at.z());
  }
  return best;
}

TEST(RayCaster, FindsWhatBruteForceFinds) {
  const TriangleMesh ball = ballAt({0.01, 0.02, 0.03});
  const RayCaster rays({ball});
  std::mt19937_64 random(3);
  for (int i = 0; i < 200; ++i) {
    const Pose X = test::randomPose(random, 0.03);
    const Vector3d direction = X.linear().col(0), origin = X.translation() - 0.3 * direction;
    const double expected = nearest(ball, origin, direction);
    const auto hit = rays.first(origin, direction);
    ASSERT_EQ(hit.has_value(), std::isfinite(expected)) << "ray " << i;
    if (!hit) continue;
    EXPECT_NEAR(hit->distance, expected, 1e-9) << "ray " << i;
  }
}

TEST(RayCaster, BlocksOnlyBetweenThePoints) {
  const RayCaster rays({wallAt(0.5, 1.0)});
  EXPECT_TRUE(rays.blocked({0, 0, 0}, {0, 0, 1}, 1e-4));
  EXPECT_FALSE(rays.blocked({0, 0, 0}, {0, 0, 0.4}, 1e-4));
  EXPECT_FALSE(rays.blocked({0, 0, 0.5}, {0, 0, 1}, 1e-4)) << "what the point lies on is no obstacle";
}

// From distance d the visible cap of a sphere of radius r is nearer than sqrt(d^2 - r^2), and the depth of
// each point solves a quadratic equation.
TEST(DepthCamera, SeesTheNearCapOfASphereExactly) {
  const TriangleMesh ball = ballAt(Vector3d::Zero());
  for (const NamedPose& view : viewRing(ball)) {
    const DepthView seen = seeFrom({ball, {}, false}, view.X_OS, small().withoutErrors());
    const PointCloud cloud = seen.objectCloud_O();
    const Vector3d eye = view.X_OS.translation();
    const double pixels = 144.0 * 144.0 * M_PI * kRadius * kRadius / (0.49 - kRadius * kRadius);
    EXPECT_NEAR(static_cast<double>(cloud.size()), pixels, 0.03 * pixels) << view.name;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      ASSERT_NEAR(cloud.point(i).norm(), kRadius, 6e-5) << "off the ball by more than its facets";
      ASSERT_LT((cloud.point(i) - eye).norm(), std::sqrt(0.49 - kRadius * kRadius) + 2e-3);
    }
  }
}

TEST(DepthCamera, MeasuresAWallExactlyAndInItsFrame) {
  std::mt19937_64 random(5);
  const Pose X_OS = test::randomPose(random, 1.0);
  TriangleMesh wall = wallAt(0.8, 2.0);
  for (Vector3d& v : wall.vertices) v = X_OS * v;
  const DepthView seen = seeFrom({wall, {}, false}, X_OS, small().withoutErrors());
  ASSERT_EQ(measured(seen), 160u * 120u);
  for (const float depth : seen.depth_m) ASSERT_NEAR(depth, 0.8, 1e-6);
  const PointCloud cloud_S = transformed(seen.objectCloud_O(), X_OS.inverse());
  EXPECT_NEAR(cloud_S.x.front(), -0.8 * 79.5 / 144, 1e-5) << "the first pixel is at the top left";
  EXPECT_NEAR(cloud_S.y.front(), -0.8 * 59.5 / 144, 1e-5);
}

TEST(DepthCamera, DoesNotSeeWhatAnotherObjectHides) {
  const TriangleMesh ball = ballAt({0, 0, 0.8});
  const DepthCameraOptions perfect = small().withoutErrors();
  const DepthView alone = seeFrom({ball, {}, false}, Pose::Identity(), perfect);
  EXPECT_GT(alone.objectCloud_O().size(), 200u);
  const DepthView hidden = seeFrom({ball, {wallAt(0.6, 0.06)}, false}, Pose::Identity(), perfect);
  EXPECT_EQ(hidden.objectCloud_O().size(), 0u);
  EXPECT_GT(hidden.fullCloud_O().size(), 200u) << "the wall itself is seen";
  TriangleMesh half = wallAt(0.6, 0.06);
  for (Vector3d& v : half.vertices) v.x() = std::max(v.x(), 0.0);
  const auto left = seeFrom({ball, {half}, false}, Pose::Identity(), perfect).objectCloud_O();
  EXPECT_NEAR(static_cast<double>(left.size()), 0.5 * static_cast<double>(alone.objectCloud_O().size()),
              0.05 * static_cast<double>(alone.objectCloud_O().size()));
  for (const float x : left.x) EXPECT_LT(x, 1e-6);
}

TEST(DepthCamera, SeesTheTableUnderTheObject) {
  const TriangleMesh ball = ballAt({0, 0, 0.3});
  const NamedPose view = viewRing(ball).front();
  const DepthView seen = seeFrom({ball, {}, true}, view.X_OS, small().withoutErrors());
  const PointCloud object = seen.objectCloud_O(), all = seen.fullCloud_O();
  EXPECT_EQ(object.size(),
            seeFrom({ball, {}, false}, view.X_OS, small().withoutErrors()).objectCloud_O().size())
      << "the table hides nothing of what is above it";
  std::size_t on_table = 0;
  for (const float z : all.z) on_table += std::abs(z - 0.25f) < 1e-4f;
  EXPECT_GE(on_table + object.size(), all.size());
  EXPECT_GT(on_table, object.size());
}

// sigma_z = z^2 sigma_d / (f b): four times as much at twice the distance.
TEST(DepthCamera, NoiseGrowsWithTheSquareOfTheDepth) {
  DepthCameraOptions noisy = small().withoutErrors();
  noisy.disparity_noise_px = 0.02;
  for (const double z : {0.5, 1.0, 2.0}) {
    const Moments moments = momentsOf(seeFrom({wallAt(z, 5), {}, false}, Pose::Identity(), noisy).depth_m);
    const double expected = z * z * 0.02 / (144 * 0.075);
    EXPECT_NEAR(moments.mean, z, 0.05 * expected + z * 1e-4);
    EXPECT_NEAR(moments.deviation, expected, 0.03 * expected) << "at " << z << " m";
  }
}

TEST(DepthCamera, DisparitiesAreMultiplesOfTheStep) {
  DepthCameraOptions stepped = small().withoutErrors();
  stepped.disparity_step_px = 0.125;
  const TriangleMesh ball = ballAt({0, 0, 0.8});
  for (const float z : seeFrom({ball, {}, false}, Pose::Identity(), stepped).depth_m) {
    if (std::isnan(z)) continue;
    const double steps = 144 * 0.075 / z / 0.125;
    EXPECT_NEAR(steps, std::round(steps), 1e-4);
  }
}

// A wall before a wall: the projector, to the right of the camera, leaves a shadow to the left of the near
// one.
TEST(DepthCamera, ShadowFallsToTheLeft) {
  DepthCameraOptions lit = small().withoutErrors();
  lit.projector_shadow = true;
  const DepthScene scene{wallAt(0.6, 0.05), {wallAt(1.0, 3.0)}, false};
  const DepthView seen = seeFrom(scene, Pose::Identity(), lit);
  // The shadow's edge on the far wall is at -0.05 - (0.05 + 0.075) * 0.4 / 0.6, seen at z = 1; that of the
  // near wall as seen from the camera at -0.05 / 0.6.
  const double shadow = 144 * ((0.05 + (0.05 + 0.075) * 0.4 / 0.6) - 0.05 / 0.6);
  const auto row = seen.depth_m.begin() + 60 * 160;
  const auto left = std::count_if(row, row + 80, [](float z) { return std::isnan(z); });
  const auto right = std::count_if(row + 80, row + 160, [](float z) { return std::isnan(z); });
  EXPECT_NEAR(static_cast<double>(left), shadow, 1.5);
  EXPECT_EQ(right, 0);
}

TEST(DepthCamera, GrazingSurfacesAndEdgesAreLost) {
  const TriangleMesh ball = ballAt({0, 0, 0.8});
  DepthCameraOptions steep = small().withoutErrors();
  const std::size_t all = measured(seeFrom({ball, {}, false}, Pose::Identity(), steep));
  steep.max_incidence_rad =
      M_PI / 6;  // the sine of the angle is the distance from the middle: a quarter stays
  const std::size_t few = measured(seeFrom({ball, {}, false}, Pose::Identity(), steep));
  EXPECT_NEAR(static_cast<double>(few), 0.25 * static_cast<double>(all), 0.05 * static_cast<double>(all));
  DepthCameraOptions losing = small().withoutErrors();
  losing.edge_loss = 1.0;
  const std::size_t inner = measured(seeFrom({ball, {}, false}, Pose::Identity(), losing));
  EXPECT_LT(inner, all);
  EXPECT_GT(inner, all * 3 / 5) << "only the rim goes";
}

TEST(DepthCamera, SameSeedGivesTheSameBytesAndAnotherOthers) {
  const TriangleMesh ball = ballAt({0, 0, 0.8});
  DepthCameraOptions options = small();
  const auto first = seeFrom({ball, {}, false}, Pose::Identity(), options).objectCloud_O();
  EXPECT_EQ(first, seeFrom({ball, {}, false}, Pose::Identity(), options).objectCloud_O());
  options.seed = 2;
  EXPECT_NE(first, seeFrom({ball, {}, false}, Pose::Identity(), options).objectCloud_O());
}

TEST(DepthCamera, RangeIsLimited) {
  EXPECT_EQ(measured(seeFrom({wallAt(0.3, 3), {}, false}, Pose::Identity(), small())), 0u);
  EXPECT_EQ(measured(seeFrom({wallAt(5.0, 9), {}, false}, Pose::Identity(), small())), 0u);
}

TEST(DepthCamera, BadOptionsAreRefused) {
  DepthCameraOptions options;
  options.focal_px = 0;
  EXPECT_THROW(seeFrom({wallAt(1, 1), {}, false}, Pose::Identity(), options), InputError);
  options = {};
  options.edge_loss = 1.5;
  EXPECT_THROW(seeFrom({wallAt(1, 1), {}, false}, Pose::Identity(), options), InputError);
}

TEST(ViewRing, LooksAtTheCentreUpright) {
  const TriangleMesh ball = ballAt({0.1, 0.2, 0.3});
  const std::vector<NamedPose> views = viewRing(ball);
  ASSERT_EQ(views.size(), 8u);
  EXPECT_EQ(views[3].name, "view3");
  for (const NamedPose& view : views) {
    const Vector3d center_S = view.X_OS.inverse() * Vector3d(0.1, 0.2, 0.3);
    EXPECT_LT((center_S - Vector3d(0, 0, 0.7)).norm(), 1e-3);
    EXPECT_NEAR(view.X_OS.linear().determinant(), 1.0, 1e-12);
    EXPECT_LT(view.X_OS.linear()(2, 1), 0.0) << "down in the picture is down";
  }
  EXPECT_LT(views[0].X_OS.translation().y(), 0.2 - 0.5);
}

}  // namespace
}  // namespace boxgrasp
