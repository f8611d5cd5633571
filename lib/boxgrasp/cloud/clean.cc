#include "boxgrasp/cloud/clean.h"

#include <algorithm>
#include <array>
#include <bit>
#include <bitset>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/parallel.h"
#include "boxgrasp/base/tolerances.h"
#include "boxgrasp/cloud/neighbours.h"
#include "boxgrasp/geometry/canonical_frame.h"
#include "boxgrasp/geometry/voxels.h"

namespace boxgrasp {

void CleanOptions::validate() const {
  requireOption(voxel_m == 0.0 || (voxel_m >= 1e-5 && voxel_m <= 1.0), "voxel_m", voxel_m,
                "0, or in [0.00001, 1]");
  requireOption(threads >= 0, "threads", threads, "at least 0");
  requireOption(outlier_neighbours >= 0 && outlier_neighbours <= 1000, "outlier_neighbours",
                outlier_neighbours, "in [0, 1000]");
  requireOption(outlier_deviations > 0.0, "outlier_deviations", outlier_deviations, "above 0");
  requireOption(max_points >= 10, "max_points", max_points, "10 or more");
}

namespace {

using Place = std::array<float, 3>;

// The different places of some points, in ascending order.
void collectPlaces(const PointCloud& cloud, std::span<const std::uint32_t> points,
                   std::vector<Place>& places) {
  places.clear();
  for (const std::uint32_t i : points) places.push_back({cloud.x[i], cloud.y[i], cloud.z[i]});
  if (places.size() == 1) return;
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
}

bool coincide(const PointCloud& cloud, std::uint32_t a, std::uint32_t b) {
  return cloud.x[a] == cloud.x[b] && cloud.y[a] == cloud.y[b] && cloud.z[a] == cloud.z[b];
}

// A number below 256, the same for equal places. Adding 0 makes 0 of -0, which is equal to it.
std::size_t markOf(const PointCloud& cloud, std::uint32_t i) {
  const auto bits = [](float value) { return std::uint64_t{std::bit_cast<std::uint32_t>(value + 0.0f)}; };
  const std::uint64_t mixed = bits(cloud.x[i]) * 0x9e3779b97f4a7c15u +
                              bits(cloud.y[i]) * 0xc2b2ae3d27d4eb4fu + bits(cloud.z[i]) * 0x165667b19e3779f9u;
  return mixed >> 56;
}

// How many different places some points have.
std::size_t countPlaces(const PointCloud& cloud, std::span<const std::uint32_t> points,
                        std::vector<Place>& places) {
  constexpr std::size_t kFew = 64;  // then most have a mark of their own, and need not be compared
  if (points.size() > kFew) {
    collectPlaces(cloud, points, places);
    return places.size();
  }
  std::size_t different = 0;
  std::bitset<256> seen;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t mark = markOf(cloud, points[i]);
    const auto before = points.first(seen[mark] ? i : 0);
    different +=
        std::ranges::none_of(before, [&](std::uint32_t other) { return coincide(cloud, points[i], other); });
    seen.set(mark);
  }
  return different;
}

// Voxels in the canonical frame, of the edge asked for or larger, until no more than max_points are occupied.
Voxels fittingVoxels(const PointCloud& cloud_K, const CleanOptions& options, double& edge_m,
                     const StopToken& stop) {
  edge_m = options.voxel_m;
  for (;;) {
    stop.check();
    Voxels voxels = sortIntoVoxels(cloud_K, edge_m);
    if (voxels.size() <= options.max_points) return voxels;
    // The occupied voxels of a surface fall with the square of the edge.
    const double excess = static_cast<double>(voxels.size()) / static_cast<double>(options.max_points);
    edge_m *= 1.01 * std::sqrt(excess);
  }
}

// Each voxel's mean.
void even(const PointCloud& cloud_C, const Voxels& voxels, int threads, CleanCloud& result) {
  constexpr std::size_t kStretch = 1024;
  result.cloud_C = meansOf(cloud_C, voxels, threads);
  std::vector<std::size_t> places_in((voxels.size() + kStretch - 1) / kStretch);
  parallelFor(places_in.size(), threads, [&](std::size_t stretch) {
    std::vector<Place> places;
    const std::size_t end = std::min(voxels.size(), (stretch + 1) * kStretch);
    for (std::size_t i = stretch * kStretch; i < end; ++i)
      places_in[stretch] += countPlaces(cloud_C, voxels.points(i), places);
  });
  const std::size_t places = std::accumulate(places_in.begin(), places_in.end(), std::size_t{0});
  result.duplicates = cloud_C.size() - places;
  result.merged = places - voxels.size();
}

// Each place once. The voxels serve the order alone.
void dropDuplicates(const PointCloud& cloud_C, const Voxels& voxels, CleanCloud& result) {
  std::vector<Place> places;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    collectPlaces(cloud_C, voxels.points(i), places);
    result.duplicates += voxels.points(i).size() - places.size();
    for (const auto& [x, y, z] : places) result.cloud_C.push(Vector3d(x, y, z));
  }
}

// A distance about that between neighbours, for points spread over a surface of the cloud's size.
double typicalSpacing(const PointCloud& cloud) {
  const double spacing = bounds(cloud).sizes().norm() / std::sqrt(2.0 * static_cast<double>(cloud.size()));
  return std::max(spacing, tolerance::kCoincident);
}

// The indices whose mean distance to their neighbours is not far above that of all (Rusu et al., "Towards 3D
// point cloud based object maps", as in PCL's StatisticalOutlierRemoval).
std::vector<std::uint32_t> inliers(const std::vector<double>& distances, double deviations) {
  const double n = static_cast<double>(distances.size());
  double sum = 0.0, sum_of_squares = 0.0;
  for (const double d : distances) {
    sum += d;
    sum_of_squares += d * d;
  }
  const double variance = std::max(0.0, (sum_of_squares - sum * sum / n) / (n - 1.0));
  const double farthest = sum / n + deviations * std::sqrt(variance);
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (distances[i] <= farthest) kept.push_back(static_cast<std::uint32_t>(i));
  }
  return kept;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Drops the outliers and measures the spacing of the others.
void judgeByNeighbours(const CleanOptions& options, double spacing_m, CleanCloud& result,
                       const StopToken& stop) {
  const std::size_t n = result.cloud_C.size();
  if (n < 2) return;
  const bool judged =
      options.outlier_neighbours > 0 && n > static_cast<std::size_t>(options.outlier_neighbours);
  const int k = judged ? options.outlier_neighbours : 1;
  NeighbourDistances distances =
      neighbourDistances(result.cloud_C, k, 0.72 * std::sqrt(k) * spacing_m, options.threads, stop);
  if (judged) {
    const auto kept = inliers(distances.mean, options.outlier_deviations);
    result.outliers = n - kept.size();
    result.cloud_C = select(result.cloud_C, kept);
    for (std::size_t i = 0; i < kept.size(); ++i) distances.nearest[i] = distances.nearest[kept[i]];
    distances.nearest.resize(kept.size());
  }
  result.spacing_m = median(std::move(distances.nearest));
}

}  // namespace

CleanCloud clean(const PointCloud& cloud_C, const CleanOptions& options, const StopToken& stop) {
  options.validate();
  assert(!cloud_C.empty());
  const PointCloud cloud_K = transformed(cloud_C, canonicalFrame(cloud_C).inverse());
  CleanCloud result;
  double spacing_m = typicalSpacing(cloud_C);
  if (options.voxel_m > 0.0) {
    const Voxels voxels = fittingVoxels(cloud_K, options, result.voxel_m, stop);
    even(cloud_C, voxels, options.threads, result);
    spacing_m = result.voxel_m;
  } else {
    const double edge_m = std::max(bounds(cloud_K).sizes().norm() / 1024.0, tolerance::kCoincident);
    dropDuplicates(cloud_C, sortIntoVoxels(cloud_K, edge_m), result);
  }
  judgeByNeighbours(options, spacing_m, result, stop);
  return result;
}

}  // namespace boxgrasp
