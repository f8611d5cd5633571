#include "boxgrasp/geometry/voxels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "boxgrasp/base/parallel.h"
#include "boxgrasp/base/simd.h"

namespace boxgrasp {
namespace voxel_passes {

struct Axis {
  double first;  // number of the cloud's first voxel along the axis
  std::int64_t stride;
};

struct Grid {
  double per_edge;
  Axis x, y, z;
};

BOXGRASP_SIMD_PART std::int32_t numberAlong(const Axis& axis, double per_edge, float value) {
  return static_cast<std::int32_t>(value * per_edge + 0.5 - axis.first);
}

// The keys of points' voxels. Pre: they fit.
template <typename Key>
BOXGRASP_SIMD_PART void fillKeys(const float* px, const float* py, const float* pz, std::size_t n,
                                 const Grid& grid, Key* __restrict keys) {
  const auto [per_edge, x, y, z] = grid;
  const auto stride_y = static_cast<Key>(y.stride), stride_z = static_cast<Key>(z.stride);
  for (std::size_t i = 0; i < n; ++i) {
    keys[i] = static_cast<Key>(numberAlong(x, per_edge, px[i])) +
              stride_y * static_cast<Key>(numberAlong(y, per_edge, py[i])) +
              stride_z * static_cast<Key>(numberAlong(z, per_edge, pz[i]));
  }
}

BOXGRASP_SIMD void keysOf(const float* px, const float* py, const float* pz, std::size_t n, const Grid& grid,
                          std::uint32_t* keys) {
  fillKeys(px, py, pz, n, grid, keys);
}

BOXGRASP_SIMD void keysOf(const float* px, const float* py, const float* pz, std::size_t n, const Grid& grid,
                          std::uint64_t* keys) {
  fillKeys(px, py, pz, n, grid, keys);
}

}  // namespace voxel_passes

namespace {

using voxel_passes::Grid;

// Keys of 32 bits do for most clouds, in half the memory and time.
template <typename Key>
struct KeyedPoint {
  Key key;
  std::uint32_t index;
};

// The voxels around a cloud: all keys are below `end`.
struct CloudGrid {
  Grid grid;
  std::int64_t end;
};

CloudGrid gridAround(const PointCloud& cloud, double edge_m) {
  const Eigen::AlignedBox3d box = bounds(cloud);
  const double per_edge = 1.0 / std::max(edge_m, std::ldexp(box.sizes().maxCoeff(), -20));
  Grid grid{per_edge, {}, {}, {}};
  std::int64_t stride = 1;
  int at = 0;
  for (voxel_passes::Axis* axis : {&grid.x, &grid.y, &grid.z}) {
    const double last = std::floor(box.max()[at] * per_edge + 0.5);
    *axis = {std::floor(box.min()[at] * per_edge + 0.5), stride};
    stride *= static_cast<std::int64_t>(last - axis->first) + 3;
    ++at;
  }
  return {grid, stride};
}

template <typename Key>
std::vector<Key> keysIn(const Grid& grid, const PointCloud& cloud) {
  std::vector<Key> keys(cloud.size());
  voxel_passes::keysOf(cloud.x.data(), cloud.y.data(), cloud.z.data(), cloud.size(), grid, keys.data());
  return keys;
}

// A sort by some digits, each of so many bits, from the lowest on; the order of equals is kept.
constexpr int kDigitBits = 11;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;

template <typename Key>
std::size_t digitOf(Key key, int place) {
  return static_cast<std::size_t>(key >> (place * kDigitBits)) % kDigits;
}

// For each place, where the points with each digit there begin.
template <typename Key>
std::vector<std::array<std::uint32_t, kDigits>> startsOf(const std::vector<Key>& keys, int places) {
  std::vector<std::array<std::uint32_t, kDigits>> starts(static_cast<std::size_t>(places));
  for (const Key key : keys) {
    for (int place = 0; place < places; ++place)
      ++starts[static_cast<std::size_t>(place)][digitOf(key, place)];
  }
  for (auto& of_place : starts) std::exclusive_scan(of_place.begin(), of_place.end(), of_place.begin(), 0u);
  return starts;
}

template <typename Key>
std::vector<KeyedPoint<Key>> sortedByKey(std::vector<Key> keys, std::int64_t end) {
  const int bits = std::bit_width(static_cast<std::uint64_t>(end));
  const int places = std::max(1, (bits + kDigitBits - 1) / kDigitBits);
  auto starts = startsOf(keys, places);
  std::vector<KeyedPoint<Key>> points(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    points[starts[0][digitOf(keys[i], 0)]++] = {keys[i], static_cast<std::uint32_t>(i)};
  std::vector<Key>().swap(keys);  // a million points have 4 MB of them
  std::vector<KeyedPoint<Key>> sorted(points.size());
  for (int place = 1; place < places; ++place) {
    for (const auto& point : points)
      sorted[starts[static_cast<std::size_t>(place)][digitOf(point.key, place)]++] = point;
    points.swap(sorted);
  }
  return points;
}

template <typename Key>
void sortInto(Voxels& voxels, const CloudGrid& around, const PointCloud& cloud) {
  const std::vector<KeyedPoint<Key>> points = sortedByKey<Key>(keysIn<Key>(around.grid, cloud), around.end);
  voxels.order.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    voxels.order[i] = points[i].index;
    if (i > 0 && points[i].key == points[i - 1].key) continue;
    voxels.begin.push_back(static_cast<std::uint32_t>(i));
    voxels.keys.push_back(static_cast<std::int64_t>(points[i].key));
  }
  voxels.begin.push_back(static_cast<std::uint32_t>(points.size()));
}

// Which voxels are occupied; those around the grid, where neighbours are looked for too, are not.
class Occupancy {
 public:
  Occupancy(const CloudGrid& around, const std::vector<std::uint32_t>& keys)
      : margin_(around.grid.z.stride + around.grid.y.stride + 1),
        occupied_(static_cast<std::size_t>(around.end + 2 * margin_)) {
    for (const std::uint32_t key : keys) size_ += std::exchange(at(key), 1) == 0;
    for (const int layer : {-1, 0, 1}) {
      for (const int row : {-1, 0, 1}) {
        for (const int step : {-1, 0, 1})
          neighbours_.push_back(layer * around.grid.z.stride + row * around.grid.y.stride + step);
      }
    }
  }

  std::size_t size() const { return size_; }

  // Takes out the voxels that hang together with this one, and returns how many they are.
  std::size_t takeConnected(std::int64_t first) {
    std::vector<std::int64_t> taken;
    const auto take = [&](std::int64_t key) {
      if (std::exchange(at(key), 0) != 0) taken.push_back(key);
    };
    take(first);
    for (std::size_t i = 0; i < taken.size(); ++i) {
      const std::int64_t key = taken[i];
      for (const std::int64_t step : neighbours_) take(key + step);
    }
    return taken.size();
  }

 private:
  char& at(std::int64_t key) { return occupied_[static_cast<std::size_t>(key + margin_)]; }

  std::int64_t margin_;
  std::vector<char> occupied_;
  std::vector<std::int64_t> neighbours_;  // from a key to those around it, and to itself
  std::size_t size_ = 0;
};

}  // namespace

Voxels sortIntoVoxels(const PointCloud& cloud, double edge_m) {
  assert(!cloud.empty() && edge_m > 0.0);
  const CloudGrid around = gridAround(cloud, edge_m);
  Voxels voxels;
  voxels.stride_y = around.grid.y.stride;
  voxels.stride_z = around.grid.z.stride;
  if (around.end <= std::numeric_limits<std::uint32_t>::max())
    sortInto<std::uint32_t>(voxels, around, cloud);
  else
    sortInto<std::uint64_t>(voxels, around, cloud);
  return voxels;
}

bool voxelsHangTogether(const PointCloud& cloud, double edge_m) {
  assert(!cloud.empty() && edge_m > 0.0);
  constexpr std::size_t kLeast = 1 << 16;
  const CloudGrid around = gridAround(cloud, edge_m);
  if (around.end > static_cast<std::int64_t>(std::max(kLeast, 4 * cloud.size()))) return false;
  const std::vector<std::uint32_t> keys = keysIn<std::uint32_t>(around.grid, cloud);
  Occupancy occupied(around, keys);
  return occupied.takeConnected(keys.front()) == occupied.size();
}

Vector3d meanOf(const PointCloud& cloud, std::span<const std::uint32_t> points) {
  constexpr double kUnits = 0x1p26;  // per metre
  std::int64_t x = 0, y = 0, z = 0;
  for (const std::uint32_t i : points) {
    x += static_cast<std::int64_t>(cloud.x[i] * kUnits);
    y += static_cast<std::int64_t>(cloud.y[i] * kUnits);
    z += static_cast<std::int64_t>(cloud.z[i] * kUnits);
  }
  const Vector3d sum(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
  return sum / (kUnits * static_cast<double>(points.size()));
}

PointCloud meansOf(const PointCloud& cloud, const Voxels& voxels, int threads) {
  constexpr std::size_t kStretch = 1024;
  PointCloud means;
  means.resize(voxels.size());
  parallelFor((voxels.size() + kStretch - 1) / kStretch, threads, [&](std::size_t stretch) {
    const std::size_t end = std::min(voxels.size(), (stretch + 1) * kStretch);
    for (std::size_t i = stretch * kStretch; i < end; ++i) {
      const Eigen::Vector3f mean = meanOf(cloud, voxels.points(i)).cast<float>();
      means.x[i] = mean.x();
      means.y[i] = mean.y();
      means.z[i] = mean.z();
    }
  });
  return means;
}

NeighbourSweep::NeighbourSweep(const Voxels& voxels, std::size_t first) : voxels_(voxels) {
  if (first == 0) return;
  for (int row = 0; row < 9; ++row)
    row_[row] = static_cast<std::size_t>(std::ranges::lower_bound(voxels.keys, middleOf(row, first) - 1) -
                                         voxels.keys.begin());
}

}  // namespace boxgrasp
