// The minimum volume box of 100,000 points, on one thread, beside CGAL's oriented_bounding_box and Qhull's
// three-dimensional hull alone. Counters of minVolumeBox:
//   volume_to_cgal   its volume divided by that of CGAL's box (below 1: ours is smaller)
//   cgal_time_ratio  CGAL's time divided by its own, both of this run (the best of three for CGAL): higher is
//   better
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/optimal_bounding_box.h>
#include <benchmark/benchmark.h>

#include <cmath>
#include <ctime>
#include <functional>
#include <map>
#include <numbers>
#include <stdexcept>

#include "boxgrasp/geometry/canonical_frame.h"
#include "boxgrasp/geometry/min_volume_box.h"
#include "boxgrasp/geometry/triangle_mesh.h"
#include "qhull_yardstick.h"
#include "random_pose.h"

namespace boxgrasp {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr std::size_t kPoints = 100'000;

// A grid of n x n squares over the image of [0, 1]^2, each cut into two triangles.
TriangleMesh surface(const std::function<Vector3d(double, double)>& image) {
  constexpr std::uint32_t n = 120;
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (std::uint32_t j = 0; j <= n; ++j) mesh.vertices.push_back(image(1.0 * i / n, 1.0 * j / n));
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      mesh.triangles.push_back({a, b, a + 1});
      mesh.triangles.push_back({b, b + 1, a + 1});
    }
  }
  return mesh;
}

// A bent tube that grows thinner to one end, like a banana.
Vector3d horn(double u, double v) {
  const double bend = 0.35 * kTurn * u, thickness = 0.03 * (1.1 - u);
  const Vector3d outward(std::cos(bend), std::sin(bend), 0.0);
  return outward * (0.1 + thickness * std::cos(kTurn * v)) +
         Vector3d::UnitZ() * thickness * std::sin(kTurn * v);
}

// A sphere with waves on it.
Vector3d bumpy(double u, double v) {
  const double polar = 0.5 * kTurn * u, azimuth = kTurn * v;
  const double radius =
      0.1 + 0.02 * std::sin(3.0 * polar) * std::cos(2.0 * azimuth) + 0.01 * std::cos(5.0 * azimuth + polar);
  return radius * Vector3d(std::sin(polar) * std::cos(azimuth), 0.8 * std::sin(polar) * std::sin(azimuth),
                           1.3 * std::cos(polar));
}

// A flat twisted band.
Vector3d band(double u, double v) {
  const double twist = 0.2 * kTurn * u;
  return {0.2 * u, 0.04 * (v - 0.5) * std::cos(twist),
          0.04 * (v - 0.5) * std::sin(twist) + 0.01 * std::sin(kTurn * u)};
}

const PointCloud& cloudOf(int shape) {
  static const std::array<PointCloud, 3> clouds = [] {
    std::mt19937_64 random(1);
    std::array<PointCloud, 3> result;
    const std::array images{horn, bumpy, band};
    for (std::size_t i = 0; i < 3; ++i) {
      result[i] = transformed(sampleSurface(surface(images[i]), kPoints, i), test::randomPose(random));
    }
    return result;
  }();
  return clouds.at(static_cast<std::size_t>(shape));
}

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

std::vector<Kernel::Point_3> cgalPoints(const PointCloud& cloud) {
  std::vector<Kernel::Point_3> points;
  for (std::size_t i = 0; i < cloud.size(); ++i) points.emplace_back(cloud.x[i], cloud.y[i], cloud.z[i]);
  return points;
}

double cgalVolume(const std::vector<Kernel::Point_3>& points) {
  std::array<Kernel::Point_3, 8> corners;
  CGAL::oriented_bounding_box(points, corners, CGAL::parameters::use_convex_hull(true));
  const auto edge = [&](int i) { return std::sqrt(CGAL::squared_distance(corners[0], corners[i])); };
  return edge(1) * edge(3) * edge(5);
}

// Processor time, so that other programs on the machine do not count.
double seconds(const std::function<void()>& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

struct Yardstick {
  double volume, seconds;
};

const Yardstick& cgalOf(int shape) {
  static std::map<int, Yardstick> known;
  if (const auto found = known.find(shape); found != known.end()) return found->second;
  const auto points = cgalPoints(cloudOf(shape));
  Yardstick yardstick{0.0, std::numeric_limits<double>::infinity()};
  for (int i = 0; i < 3; ++i) {
    yardstick.seconds = std::min(yardstick.seconds, seconds([&] { yardstick.volume = cgalVolume(points); }));
  }
  return known[shape] = yardstick;
}

void minVolumeBoxOf(benchmark::State& state) {
  const int shape = static_cast<int>(state.range(0));
  const PointCloud& cloud = cloudOf(shape);
  const Yardstick cgal = cgalOf(shape);
  double volume = 0.0, total = 0.0;
  for (auto _ : state) total += seconds([&] { volume = minVolumeBox(cloud).volume(); });
  state.counters["volume_to_cgal"] = volume / cgal.volume;
  state.counters["cgal_time_ratio"] = cgal.seconds * static_cast<double>(state.iterations()) / total;
}

void canonicalFrameOf(benchmark::State& state) {
  const PointCloud& cloud = cloudOf(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(canonicalFrame(cloud));
}

void cgalOrientedBoundingBoxOf(benchmark::State& state) {
  const auto points = cgalPoints(cloudOf(static_cast<int>(state.range(0))));
  for (auto _ : state) benchmark::DoNotOptimize(cgalVolume(points));
}

void qhullOf(benchmark::State& state) {
  std::vector<coordT> coordinates = test::qhullCoordinates(cloudOf(static_cast<int>(state.range(0))));
  for (auto _ : state) test::buildQhull(coordinates);
}

BENCHMARK(minVolumeBoxOf)->DenseRange(0, 2)->ArgName("shape")->Unit(benchmark::kMillisecond);
BENCHMARK(canonicalFrameOf)->DenseRange(0, 2)->ArgName("shape")->Unit(benchmark::kMillisecond);
BENCHMARK(cgalOrientedBoundingBoxOf)->DenseRange(0, 2)->ArgName("shape")->Unit(benchmark::kMillisecond);
BENCHMARK(qhullOf)->DenseRange(0, 2)->ArgName("shape")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace boxgrasp
