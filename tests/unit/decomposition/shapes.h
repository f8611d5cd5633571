// Clouds of simple solids for the tests of the decomposition. Metres.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "boxgrasp/base/random.h"
#include "boxgrasp/geometry/point_cloud.h"
#include "random_pose.h"

namespace boxgrasp::test {

// An axis-aligned brick: a corner and the opposite one.
struct Brick {
  Vector3d low, high;
  double volume() const { return (high - low).prod(); }
};

// n points spread evenly over the bricks, by volume.
inline PointCloud inBricks(const std::vector<Brick>& bricks, std::size_t n, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  double total = 0.0;
  for (const Brick& brick : bricks) total += brick.volume();
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    double at = uniform(random, 0.0, total);
    std::size_t k = 0;
    while (k + 1 < bricks.size() && at >= bricks[k].volume()) at -= bricks[k++].volume();
    const double u = uniform(random), v = uniform(random), w = uniform(random);
    cloud.push(bricks[k].low + (bricks[k].high - bricks[k].low).cwiseProduct(Vector3d(u, v, w)));
  }
  return cloud;
}

inline PointCloud brick(std::size_t n) { return inBricks({{{0, 0, 0}, {0.12, 0.08, 0.05}}}, n); }

// Letters of strokes 0.03 wide, in a plate 0.03 thick.
inline PointCloud letterL(std::size_t n) {
  return inBricks({{{0, 0, 0}, {0.03, 0.12, 0.03}}, {{0.03, 0, 0}, {0.12, 0.03, 0.03}}}, n);
}

inline PointCloud letterT(std::size_t n) {
  return inBricks({{{0, 0.12, 0}, {0.15, 0.15, 0.03}}, {{0.06, 0, 0}, {0.09, 0.12, 0.03}}}, n);
}

inline PointCloud letterU(std::size_t n) {
  return inBricks({{{0, 0, 0}, {0.15, 0.03, 0.03}},
                   {{0, 0.03, 0}, {0.03, 0.15, 0.03}},
                   {{0.12, 0.03, 0}, {0.15, 0.15, 0.03}}},
                  n);
}

inline PointCloud dumbbell(std::size_t n) {
  return inBricks({{{0, 0, 0}, {0.06, 0.06, 0.06}},
                   {{0.06, 0.022, 0.022}, {0.16, 0.038, 0.038}},
                   {{0.16, 0, 0}, {0.22, 0.06, 0.06}}},
                  n);
}

inline PointCloud sphere(std::size_t n, double radius = 0.05) {
  std::mt19937_64 random(2);
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = normal(random), y = normal(random), z = normal(random);
    cloud.push(radius * Vector3d(x, y, z).normalized());
  }
  return cloud;
}

// The wall of an upright cylinder.
inline PointCloud cylinder(std::size_t n, double radius = 0.04, double height = 0.1) {
  std::mt19937_64 random(3);
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const double turn = uniform(random, 0.0, 2.0 * std::numbers::pi);
    cloud.push({radius * std::cos(turn), radius * std::sin(turn), height * uniform(random)});
  }
  return cloud;
}

// A cylinder with a half ring as its handle: every fifth point.
inline PointCloud mug(std::size_t n) {
  std::mt19937_64 random(4);
  PointCloud cloud = cylinder(n - n / 5);
  for (std::size_t i = 0; i < n / 5; ++i) {
    const double turn = uniform(random, -0.5, 0.5) * std::numbers::pi, y = uniform(random, -0.006, 0.006);
    cloud.push({0.04 + 0.035 * std::cos(turn), y, 0.05 + 0.035 * std::sin(turn)});
  }
  return cloud;
}

// Normally distributed lumps about random centres.
inline PointCloud blobs(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto vector = [&random] {
    const double x = normal(random), y = normal(random);
    return Vector3d(x, y, normal(random));
  };
  PointCloud cloud;
  const std::size_t lumps = 2 + uniformIndex(random, 4);
  for (std::size_t k = 0; k < lumps; ++k) {
    const Vector3d center = 0.08 * vector(), size = 0.02 * vector();
    for (std::size_t i = 0; i < n / lumps; ++i) cloud.push(center + size.cwiseProduct(vector()));
  }
  return cloud;
}

// A lattice of points in the shape of an L: columns, rows and sums tie exactly.
inline PointCloud lattice(int side) {
  PointCloud cloud;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      for (int k = 0; k < 4; ++k) {
        if (2 * i < side || 2 * j < side) cloud.push(Vector3d(i, j, k) * 0x1p-7);
      }
    }
  }
  return cloud;
}

struct NamedCloud {
  const char* name;
  PointCloud cloud;
};

inline std::vector<NamedCloud> allShapes(std::size_t n) {
  return {
      {"brick", brick(n)},
      {"L", letterL(n)},
      {"T", letterT(n)},
      {"U", letterU(n)},
      {"dumbbell", dumbbell(n)},
      {"sphere", sphere(n)},
      {"cylinder", cylinder(n)},
      {"mug", mug(n)},
      {"blobs 1", blobs(n, 1)},
      {"blobs 2", blobs(n, 2)},
      {"blobs 3", blobs(n, 3)},
      {"lattice", lattice(16)},
      {"tilted mug",
       transformed(mug(n), makePose(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix(),
                                    {0.3, 0.1, 0.5}))}};
}

}  // namespace boxgrasp::test
