#include "boxgrasp/geometry/min_volume_box.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>

#include "boxgrasp/base/tolerances.h"
#include "boxgrasp/geometry/polygon.h"
#include "random_clouds.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

using PointMaker = std::function<Vector3d(std::mt19937_64&)>;

PointCloud cloudOf(std::size_t n, const PointMaker& point, std::mt19937_64& random) {
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) cloud.push(point(random));
  return cloud;
}

Vector3d inUnitCube(std::mt19937_64& random) {
  const double x = uniform(random), y = uniform(random);
  return {x, y, uniform(random)};
}

Vector3d onUnitSphere(std::mt19937_64& random) {
  const double x = normal(random), y = normal(random);
  return Vector3d(x, y, normal(random)).normalized();
}

Vector3d onCylinder(std::mt19937_64& random) {
  const double angle = uniform(random, 0.0, 2.0 * std::numbers::pi);
  return {0.03 * std::cos(angle), 0.03 * std::sin(angle), 0.1 * uniform(random)};
}

// Two arms of a quarter of the width.
Vector3d inLetterL(std::mt19937_64& random) {
  Vector3d p = inUnitCube(random).cwiseProduct(Vector3d(0.12, 0.09, 0.03));
  p[uniform(random) < 0.5 ? 0 : 1] *= 0.25;
  return p;
}

// Evenly in a tetrahedron with random corners.
PointMaker inTetrahedron(std::mt19937_64& random) {
  std::array<Vector3d, 4> corners;
  for (Vector3d& corner : corners) corner = 0.1 * onUnitSphere(random);
  return [corners](std::mt19937_64& generator) {
    Vector3d p = Vector3d::Zero();
    double sum = 0.0;
    for (const Vector3d& corner : corners) {
      const double weight = -std::log(1.0 - uniform(generator));
      p += weight * corner;
      sum += weight;
    }
    return Vector3d(p / sum);
  };
}

std::vector<std::pair<std::string, PointCloud>> shapes(std::size_t n, std::mt19937_64& random) {
  const Vector3d extents(uniform(random, 0.02, 0.2), uniform(random, 0.02, 0.2), uniform(random, 0.005, 0.2));
  const auto stretched = [&](const PointMaker& point) {
    return PointMaker(
        [=](std::mt19937_64& generator) { return Vector3d(point(generator).cwiseProduct(extents)); });
  };
  std::vector<std::pair<std::string, PointCloud>> result{
      {"box", cloudOf(n, stretched(inUnitCube), random)},
      {"gaussian", test::gaussianCloud(n, extents, random)},
      {"ellipsoid", cloudOf(n, stretched(onUnitSphere), random)},
      {"cylinder", cloudOf(n, onCylinder, random)},
      {"letter L", cloudOf(n, inLetterL, random)},
      {"tetrahedron", cloudOf(n, inTetrahedron(random), random)}};
  for (auto& [name, cloud] : result) cloud = transformed(cloud, test::randomPose(random));
  return result;
}

void expectTightAround(const PointCloud& cloud, const OrientedBox& box) {
  const Matrix3d axes = box.X_CB.linear();
  EXPECT_LT((axes.transpose() * axes - Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_GT(axes.determinant(), 0.0) << "expected right-handed axes";
  EXPECT_GE(box.extents.x(), box.extents.y()) << "expected falling extents";
  EXPECT_GE(box.extents.y(), box.extents.z()) << "expected falling extents";
  for (std::size_t i = 0; i < cloud.size(); ++i)
    EXPECT_TRUE(box.contains(cloud.point(i), 1e-7)) << "point " << i;
  const OrientedBox tight = boxAround(cloud, axes);
  EXPECT_LT((tight.extents - box.extents).norm(), 1e-12)
      << "expected a box that touches the points on every side";
}

TEST(MinVolumeBox, ContainsThePointsAndTouchesThem) {
  std::mt19937_64 random(1);
  for (const std::size_t n : {1u, 2u, 3u, 4u, 20u, 96u, 97u, 3000u}) {
    for (const auto& [name, cloud] : shapes(n, random)) {
      SCOPED_TRACE(name + " of " + std::to_string(n));
      expectTightAround(cloud, minVolumeBox(cloud));
    }
  }
}

TEST(MinVolumeBox, IsWithinTwoPerMilleOfTheExhaustiveSearch) {
  std::mt19937_64 random(2);
  for (const std::size_t n : {10u, 60u, 250u}) {
    for (const auto& [name, cloud] : shapes(n, random)) {
      const double best = minVolumeBox(cloud, {.exhaustive = true}).volume();
      EXPECT_LT(minVolumeBox(cloud).volume(), 1.002 * best) << name << " of " << n;
    }
  }
}

TEST(BoxSearch, KnowsAtEachStepWhatTheVolumeWillBeAtLeast) {
  std::mt19937_64 random(9);
  for (const std::size_t n : {1u, 20u, 96u, 300u, 3000u}) {
    for (const auto& [name, cloud] : shapes(n, random)) {
      SCOPED_TRACE(name + " of " + std::to_string(n));
      const OrientedBox expected = minVolumeBox(cloud);
      BoxSearch search(cloud);
      do {
        EXPECT_LT(search.volumeAtLeast(), expected.volume());
      } while (search.advance());
      EXPECT_GT(search.volumeAtLeast(), 0.97 * expected.volume()) << "expected both to meet in the end";
      EXPECT_EQ(search.box().X_CB.matrix(), expected.X_CB.matrix());
      EXPECT_FALSE(search.advance()) << "the end is the end";
    }
  }
}

// A box with all its corners is its own minimum volume box.
TEST(MinVolumeBox, FindsABoxAgain) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 40; ++round) {
    const Vector3d extents(uniform(random, 0.1, 0.2), uniform(random, 0.05, 0.1),
                           uniform(random, 0.002, 0.05));
    PointCloud cloud = test::boxCloud(round % 2 == 0 ? 0 : 2000, extents, random);
    OrientedBox expected;
    expected.extents = extents;
    for (const Vector3d& corner : expected.corners()) cloud.push(corner);
    const Pose X_AC = test::randomPose(random);
    const OrientedBox found = minVolumeBox(transformed(cloud, X_AC));
    EXPECT_LT(found.volume(), 1.002 * extents.prod()) << "extents " << extents.transpose();
    EXPECT_LT((found.X_CB.translation() - X_AC.translation()).norm(), 1e-3 * extents.x());
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GT(std::abs(found.X_CB.linear().col(axis).dot(X_AC.linear().col(axis))), 0.9999)
          << "axis " << axis;
    }
  }
}

// The regular tetrahedron in the unit cube: no box around it is smaller than the cube.
TEST(MinVolumeBox, FindsTheCubeAroundTheRegularTetrahedron) {
  std::mt19937_64 random(4);
  PointCloud cloud;
  for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(1, 1, 0), Vector3d(1, 0, 1), Vector3d(0, 1, 1)})
    cloud.push(p);
  for (int round = 0; round < 20; ++round) {
    EXPECT_NEAR(minVolumeBox(transformed(cloud, test::randomPose(random))).volume(), 1.0, 1e-3);
  }
}

TEST(MinVolumeBox, MovesWithTheCloud) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 20; ++round) {
    const PointCloud cloud = cloudOf(40 << (round % 8), inTetrahedron(random), random);
    const OrientedBox box = minVolumeBox(cloud);
    const Pose X_AC = test::randomPose(random);
    const OrientedBox moved = minVolumeBox(transformed(cloud, X_AC));
    EXPECT_LT((moved.extents - box.extents).norm(), 2e-3 * box.extents.norm()) << cloud.size() << " points";
    EXPECT_LT((moved.X_CB.matrix() - (X_AC * box.X_CB).matrix()).norm(), 2e-2) << cloud.size() << " points";
  }
}

TEST(MinVolumeBox, VolumeDoesNotDependOnThePoseOfSymmetricShapes) {
  std::mt19937_64 random(6);
  for (const auto& [name, cloud] : shapes(800, random)) {
    const double volume = minVolumeBox(cloud).volume();
    for (int round = 0; round < 5; ++round) {
      const double moved = minVolumeBox(transformed(cloud, test::randomPose(random))).volume();
      EXPECT_NEAR(moved / volume, 1.0, 2e-3) << name;
    }
  }
}

TEST(MinVolumeBox, DoesNotDependOnTheOrderOfThePoints) {
  std::mt19937_64 random(7);
  for (const std::size_t n : {7u, 96u, 500u, 9000u}) {
    for (const auto& [name, cloud] : shapes(n, random)) {
      const PointCloud shuffled = test::shuffled(cloud, random);
      const OrientedBox first = minVolumeBox(cloud), second = minVolumeBox(shuffled);
      EXPECT_EQ(first.X_CB.matrix(), second.X_CB.matrix())
          << name << " of " << n << ": expected the same bits";
      EXPECT_EQ(first.extents, second.extents) << name << " of " << n << ": expected the same bits";
    }
  }
}

TEST(MinVolumeBox, DegenerateCloudsGiveFlatBoxes) {
  std::mt19937_64 random(8);
  for (const double noise : {0.0, 1e-6}) {
    for (int dimensions = 0; dimensions <= 2; ++dimensions) {
      for (const std::size_t n : {1u, 2u, 50u, 400u}) {
        PointCloud cloud;
        for (std::size_t i = 0; i < n; ++i) {
          Vector3d p = inUnitCube(random).cwiseProduct(Vector3d(0.3, 0.1, 0.0));
          for (int axis = dimensions; axis < 3; ++axis) p[axis] = noise * normal(random);
          cloud.push(p);
        }
        cloud = transformed(cloud, test::randomPose(random));
        const OrientedBox box = minVolumeBox(cloud);
        SCOPED_TRACE(std::to_string(n) + " points of dimension " + std::to_string(dimensions));
        expectTightAround(cloud, box);
        for (int axis = dimensions; axis < 3; ++axis) EXPECT_EQ(box.extents[axis], tolerance::kFlatExtent);
      }
    }
  }
}

// In the plane the exact answer is known: the smallest rectangle.
TEST(MinVolumeBox, OfAPlanarCloudIsItsSmallestRectangle) {
  std::mt19937_64 random(9);
  for (int round = 0; round < 10; ++round) {
    PointCloud cloud;
    for (int i = 0; i < 30 << (round % 5); ++i)
      cloud.push({0.1 * normal(random), 0.05 * uniform(random), 0.0});
    std::vector<Vector2d> flat;
    for (std::size_t i = 0; i < cloud.size(); ++i) flat.emplace_back(cloud.x[i], cloud.y[i]);
    const double area = minAreaRectangle(convexHull(flat)).area();
    const double volume = minVolumeBox(transformed(cloud, test::randomPose(random))).volume();
    EXPECT_LT(volume, 1.002 * area * tolerance::kFlatExtent);
  }
}

TEST(MinVolumeBox, SurvivesAnyUnitAndPlace) {
  std::mt19937_64 random(10);
  const PointCloud cloud = cloudOf(300, inTetrahedron(random), random);
  for (const double scale : {1e-6, 1e3, 1e12, 1e37}) {
    PointCloud scaled;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      scaled.push(scale * (cloud.point(i) + Vector3d(0.1, 0.1, 0.1)));
    const OrientedBox box = minVolumeBox(scaled);
    EXPECT_TRUE(box.X_CB.matrix().allFinite()) << "scale " << scale;
    for (std::size_t i = 0; i < scaled.size(); ++i) {
      EXPECT_TRUE(box.contains(scaled.point(i), 1e-12 * scale + 1e-12)) << "scale " << scale;
    }
  }
}

TEST(MinVolumeBox, StopsWhenAsked) {
  std::mt19937_64 random(11);
  const PointCloud cloud = test::gaussianCloud(200, {1, 1, 1}, random);
  const StopToken expired(StopToken::Clock::now());
  EXPECT_THROW(minVolumeBox(cloud, {}, expired), Stopped);
  EXPECT_THROW(minVolumeBox(cloud, {.exhaustive = true}, expired), Stopped);
}

// The vertices of a binary PLY file that starts with x, y and z as floats and has no other vertex property.
PointCloud readVertices(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::size_t n = 0;
  for (std::string line; std::getline(file, line) && line != "end_header";) {
    if (line.starts_with("element vertex ")) n = std::stoul(line.substr(15));
  }
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    float p[3];
    file.read(reinterpret_cast<char*>(p), sizeof p);
    cloud.push({p[0], p[1], p[2]});
  }
  return cloud;
}

// On every fortieth vertex the exhaustive search is affordable. Its volume bounds that of the whole from
// below, and the whole measured in its orientation from above.
TEST(MinVolumeBox, OfScannedObjects) {
  const std::filesystem::path folder = BOXGRASP_SOURCE_DIR "/../shared/data/objects/ycb";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no scanned objects in " << folder;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".ply") continue;
    const PointCloud cloud = readVertices(entry.path());
    PointCloud some;
    for (std::size_t i = 0; i < cloud.size(); i += 40) some.push(cloud.point(i));
    SCOPED_TRACE(entry.path().filename());
    expectTightAround(cloud, minVolumeBox(cloud));
    const OrientedBox best_of_some = minVolumeBox(some, {.exhaustive = true});
    EXPECT_LT(minVolumeBox(some).volume(), 1.002 * best_of_some.volume());
    const double volume = minVolumeBox(cloud).volume();
    EXPECT_GT(volume, 0.998 * best_of_some.volume());
    EXPECT_LT(volume, 1.002 * boxAround(cloud, best_of_some.X_CB.linear()).volume());
  }
}

}  // namespace
}  // namespace boxgrasp
