#include "boxgrasp/cloud/completion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/cloud/sensor_view.h"
#include "boxgrasp/geometry/point_grid.h"
#include "error_of.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

using ::testing::HasSubstr;
using Verdict = SensorView::Verdict;

constexpr double kSpacing_m = 0.0015;
const Vector3d kUp = Vector3d::UnitZ();
// How deep a round body is, its near side hardly tells.
constexpr double kRoundTolerance_m = 0.012;

struct SurfacePoint {
  Vector3d p, normal;
};

// A grid of points on a box that stands on z = 0.
std::vector<SurfacePoint> boxSurface(const Vector3d& size) {
  std::vector<SurfacePoint> all;
  const Vector3d half = size / 2;
  const auto add = [&](int axis, double sign) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (double a = -half[u]; a <= half[u]; a += kSpacing_m) {
      for (double b = -half[v]; b <= half[v]; b += kSpacing_m) {
        Vector3d p = Vector3d::Zero(), normal = Vector3d::Zero();
        p[axis] = sign * half[axis];
        p[u] = a;
        p[v] = b;
        normal[axis] = sign;
        all.push_back({p + Vector3d(0, 0, half.z()), normal});
      }
    }
  };
  for (const double sign : {-1.0, 1.0}) {
    for (int axis = 0; axis < 3; ++axis) add(axis, sign);
  }
  return all;
}

std::vector<SurfacePoint> canSurface(double radius, double height) {
  std::vector<SurfacePoint> all;
  for (double z = 0; z <= height; z += kSpacing_m) {
    for (double a = 0; a < 2 * std::numbers::pi; a += kSpacing_m / radius) {
      const Vector3d normal(std::cos(a), std::sin(a), 0);
      all.push_back({radius * normal + z * kUp, normal});
    }
  }
  for (double r = kSpacing_m; r < radius; r += kSpacing_m) {
    for (double a = 0; a < 2 * std::numbers::pi; a += kSpacing_m / r) {
      all.push_back({{r * std::cos(a), r * std::sin(a), height}, kUp});
      all.push_back({{r * std::cos(a), r * std::sin(a), 0.0}, -kUp});
    }
  }
  return all;
}

// What a sensor sees of a convex body.
PointCloud seenFrom(const std::vector<SurfacePoint>& surface, const Vector3d& viewpoint) {
  PointCloud seen;
  for (const auto& [p, normal] : surface) {
    if (normal.dot((viewpoint - p).normalized()) > 0.2) seen.push(p);
  }
  return seen;
}

double shareNear(const PointCloud& points, const PointCloud& others, double distance_m) {
  const PointGrid grid(others, distance_m);
  std::size_t near = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    near += grid.nearest(points.point(i), distance_m).has_value();
  return points.empty() ? 1.0 : static_cast<double>(near) / static_cast<double>(points.size());
}

PointCloud cloudOf(const std::vector<SurfacePoint>& surface) {
  PointCloud cloud;
  for (const SurfacePoint& s : surface) cloud.push(s.p);
  return cloud;
}

const PointCloud kNothing;

void expectComplete(const std::vector<SurfacePoint>& surface, const Vector3d& viewpoint,
                    const std::optional<Vector3d>& up, double tolerance_m = 0.006) {
  const PointCloud seen = seenFrom(surface, viewpoint), truth = cloudOf(surface);
  ASSERT_LT(shareNear(truth, seen, 0.006), 0.8) << "something must be left to guess";
  const Completion guess = completed(seen, kSpacing_m, {{viewpoint}, up, kNothing});
  EXPECT_GT(shareNear(guess.guessed_C, truth, tolerance_m), 0.97) << "guessed points lie on the true surface";
  EXPECT_GT(shareNear(truth, joined(seen, guess.guessed_C), tolerance_m + 0.002), 0.97)
      << "little is missing";
}

TEST(Completion, FindsTheUnseenWallsOfABoxSeenAtACorner) {
  for (const double azimuth : {0.5, 1.0, 2.3, 4.0}) {
    SCOPED_TRACE(azimuth);
    expectComplete(boxSurface({0.06, 0.10, 0.15}), {0.7 * std::cos(azimuth), 0.7 * std::sin(azimuth), 0.45},
                   kUp);
  }
}

TEST(Completion, FindsTheBackOfACan) { expectComplete(canSurface(0.035, 0.10), {0.6, -0.3, 0.4}, kUp); }

TEST(Completion, FindsTheUndersideOfWhatLies) {
  std::vector<SurfacePoint> lying = canSurface(0.035, 0.18);
  const Eigen::AngleAxisd turn(std::numbers::pi / 2, Vector3d::UnitX());
  for (auto& [p, normal] : lying) {
    p = turn * p;
    normal = turn * normal;
  }
  expectComplete(lying, {0.4, -0.6, 0.4}, kUp, kRoundTolerance_m);
}

// A cone stands on its wide end: mirrored to its top, that would have been seen.
TEST(Completion, UsesNoLevelMirrorThatWasSeenToBeNone) {
  std::vector<SurfacePoint> cone;
  for (double z = 0; z <= 0.12; z += kSpacing_m) {
    const double radius = 0.05 * (1 - z / 0.13);
    for (double a = 0; a < 2 * std::numbers::pi; a += kSpacing_m / radius)
      cone.push_back({{radius * std::cos(a), radius * std::sin(a), z},
                      Vector3d(std::cos(a), std::sin(a), 0.05 / 0.13).normalized()});
  }
  const Vector3d viewpoint(0.6, -0.3, 0.4);
  const Completion guess = completed(seenFrom(cone, viewpoint), kSpacing_m, {{viewpoint}, kUp, kNothing});
  EXPECT_GT(guess.mirrors.size(), 0u) << guess.why_not;
  for (const Plane& mirror : guess.mirrors) EXPECT_LT(std::abs(mirror.normal_C.z()), 0.1);
  EXPECT_GT(shareNear(guess.guessed_C, cloudOf(cone), kRoundTolerance_m), 0.97);
}

TEST(Completion, TriesTheCloudsOwnAxesWhereUpIsUnknown) {
  const Vector3d size(0.06, 0.10, 0.15), viewpoint(0.5, 0.4, 0.45);
  const PointCloud seen = seenFrom(boxSurface(size), viewpoint);
  const PointCloud truth = cloudOf(boxSurface(size));
  const Completion guess = completed(seen, kSpacing_m, {{viewpoint}, std::nullopt, kNothing});
  EXPECT_GT(shareNear(guess.guessed_C, truth, 0.006), 0.97) << "on one of its six sides";
  EXPECT_GT(shareNear(truth, joined(seen, guess.guessed_C), 0.008), shareNear(truth, seen, 0.008) + 0.2)
      << "two of the three unseen sides";
}

TEST(Completion, MovesWithTheCloud) {
  const Vector3d viewpoint(0.5, 0.4, 0.45);
  const PointCloud seen = seenFrom(boxSurface({0.06, 0.10, 0.15}), viewpoint);
  const Completion guess = completed(seen, kSpacing_m, {{viewpoint}, kUp, kNothing});
  ASSERT_GT(guess.guessed_C.size(), seen.size() / 2);
  std::mt19937_64 random(3);
  for (int i = 0; i < 5; ++i) {
    const Pose X_DC = test::randomPose(random, 1.0);
    const Completion moved = completed(transformed(seen, X_DC), kSpacing_m,
                                       {{X_DC * viewpoint}, Vector3d(X_DC.linear() * kUp), kNothing});
    EXPECT_GT(shareNear(moved.guessed_C, transformed(guess.guessed_C, X_DC), 0.004), 0.99);
    EXPECT_GT(shareNear(transformed(guess.guessed_C, X_DC), moved.guessed_C, 0.004), 0.99);
  }
}

// An upright L seen along its notch: no symmetric twin of its foot can stand where the sensor looked through.
TEST(Completion, GuessesNothingWhereTheSensorLookedThrough) {
  const Vector3d viewpoint(0.2, 0.8, 0.1);
  PointCloud seen;
  for (double x = 0; x <= 0.12; x += kSpacing_m) {
    for (double z = 0; z <= 0.15; z += kSpacing_m) {
      if (x < 0.04 || z < 0.04) seen.push({x, 0.02, z});
    }
  }
  const Completion guess = completed(seen, kSpacing_m, {{viewpoint}, kUp, kNothing});
  ASSERT_FALSE(guess.guessed_C.empty()) << guess.why_not;
  for (std::size_t i = 0; i < guess.guessed_C.size(); ++i) {
    const Vector3d q = guess.guessed_C.point(i), ray = q - viewpoint;
    const Vector3d at_wall = viewpoint + ray * (0.02 - viewpoint.y()) / ray.y();
    const double outside_m = std::min(at_wall.x() - 0.04, at_wall.z() - 0.04);
    EXPECT_LT(outside_m, 4 * kSpacing_m) << "guessed at " << q.transpose() << ", seen through the notch";
    EXPECT_LT(q.y(), 0.02 + 0.006) << "guessed before the wall that was seen";
  }
}

// Two walls that meet, each seen by a sensor of its own: neither place alone could have seen this cloud, and
// nothing may be guessed where either looked through.
TEST(Completion, JoinsWhatSeveralSensorsSaw) {
  const auto surface = boxSurface({0.06, 0.10, 0.15});
  const Vector3d left(-0.7, 0.05, 0.3), front(0.05, -0.7, 0.3);
  const PointCloud seen = joined(seenFrom(surface, left), seenFrom(surface, front)), truth = cloudOf(surface);
  ASSERT_LT(shareNear(truth, seen, 0.006), 0.8);
  const Completion guess = completed(seen, kSpacing_m, {{left, front}, kUp, kNothing});
  EXPECT_GT(shareNear(guess.guessed_C, truth, 0.006), 0.97);
  EXPECT_GT(shareNear(truth, joined(seen, guess.guessed_C), 0.008), 0.97);
  const Vector3d behind(0.7, 0.05, 0.3);  // it saw a box only 60 mm wide
  PointCloud deep = seenFrom(boxSurface({0.06, 0.10, 0.15}), front);
  const PointCloud back = seenFrom(boxSurface({0.06, 0.10, 0.15}), behind);
  const Completion thin = completed(joined(deep, back), kSpacing_m, {{front, behind}, kUp, kNothing});
  ASSERT_FALSE(thin.guessed_C.empty()) << thin.why_not;
  const SensorView view(
      back, kNothing,
      Pose(Eigen::Translation3d(behind) *
           Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), Vector3d(-0.7, -0.05, -0.22))),
      2 * kSpacing_m);
  for (std::size_t i = 0; i < thin.guessed_C.size(); ++i) {
    EXPECT_NE(view.judge(thin.guessed_C.point(i), 2 * CompletionOptions{}.tolerance_m).verdict,
              Verdict::contradicted)
        << "guessed at " << thin.guessed_C.point(i).transpose() << ", where the second sensor looked through";
  }
}

TEST(Completion, GuessesNothingOfWhatIsKnownAllAround) {
  const PointCloud whole = cloudOf(boxSurface({0.06, 0.10, 0.15}));
  const Completion guess = completed(whole, kSpacing_m, {{{0.5, 0.4, 0.45}}, kUp, kNothing});
  EXPECT_TRUE(guess.guessed_C.empty());
  EXPECT_THAT(guess.why_not, HasSubstr("hidden from where the sensor stood"));
}

TEST(Completion, GuessesNothingForASensorWithinTheObject) {
  const auto surface = boxSurface({0.06, 0.10, 0.15});
  const PointCloud seen = seenFrom(surface, {0.5, 0.4, 0.45});
  for (const Vector3d& viewpoint :
       {Vector3d(0, 0, 0.05), Vector3d(0.02, 0.04, 0.1), Vector3d(0.03, 0.05, 0.15)}) {
    const Completion guess = completed(seen, kSpacing_m, {{viewpoint}, kUp, kNothing});
    EXPECT_TRUE(guess.guessed_C.empty());
    EXPECT_THAT(guess.why_not, HasSubstr("within the object")) << viewpoint.transpose();
  }
}

TEST(Completion, OfDegenerateCloudsEndsAndIsFinite) {
  PointCloud line, flat;
  for (int i = 0; i < 100; ++i) line.push({0.001 * i, 0, 0});
  for (int i = 0; i < 100; ++i) flat.push({0.002 * (i % 10), 0.002 * (i / 10), 0});
  PointCloud one;
  one.push({0.1, 0.2, 0.3});
  for (const PointCloud& cloud : {line, flat, one}) {
    for (const Vector3d& viewpoint : {Vector3d(0, 0, 0.7), Vector3d(0.5, 0, 0), cloud.point(0)}) {
      const Completion guess = completed(cloud, kSpacing_m, {{viewpoint}, std::nullopt, kNothing});
      for (std::size_t i = 0; i < guess.guessed_C.size(); ++i)
        EXPECT_TRUE(guess.guessed_C.point(i).allFinite());
    }
  }
}

TEST(Completion, CanBeTurnedOffAndChecksItsOptions) {
  const Vector3d viewpoint(0.5, 0.4, 0.45);
  const PointCloud seen = seenFrom(boxSurface({0.06, 0.10, 0.15}), viewpoint);
  EXPECT_TRUE(
      completed(seen, kSpacing_m, {{viewpoint}, kUp, kNothing}, {.enabled = false}).guessed_C.empty());
  EXPECT_THAT(test::errorOf([] { CompletionOptions{.tolerance_m = 0}.validate(); }),
              HasSubstr("completion.tolerance_m"));
  EXPECT_THAT(test::errorOf([] { CompletionOptions{.max_contradicted = 2}.validate(); }),
              HasSubstr("completion.max_contradicted"));
  EXPECT_THAT(test::errorOf([] { CompletionOptions{.max_hidden = -1}.validate(); }),
              HasSubstr("completion.max_hidden"));
}

TEST(SensorView, TellsSeenFromHiddenFromSeenThrough) {
  PointCloud wall, post;
  for (double x = -0.05; x <= 0.05; x += kSpacing_m) {
    for (double y = -0.05; y <= 0.05; y += kSpacing_m) wall.push({x, y, 1.0});
  }
  for (double y = -0.05; y <= 0.05; y += kSpacing_m) post.push({0.04, y, 0.5});
  const SensorView view(wall, post, Pose::Identity(), 2 * kSpacing_m);
  const auto verdict = [&](double x, double y, double z) { return view.judge({x, y, z}, 0.006).verdict; };
  EXPECT_EQ(verdict(0, 0, 1.002), Verdict::seen);
  EXPECT_EQ(verdict(0, 0, 1.1), Verdict::hidden);
  EXPECT_NEAR(view.judge({0, 0, 1.1}, 0.006).behind_m, 0.1, 1e-6);
  EXPECT_EQ(verdict(0, 0, 0.9), Verdict::contradicted) << "before the wall";
  EXPECT_EQ(verdict(0.2, 0, 1.0), Verdict::contradicted) << "beside the wall";
  EXPECT_EQ(verdict(0, 0, -1.0), Verdict::contradicted) << "behind the sensor";
  EXPECT_EQ(verdict(0.056, 0, 0.7), Verdict::hidden) << "behind the post, beside and before the wall";
}

}  // namespace
}  // namespace boxgrasp
