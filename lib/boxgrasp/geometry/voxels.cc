#include "boxgrasp/geometry/voxels.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "boxgrasp/base/parallel.h"
#include "boxgrasp/base/simd.h"

namespace boxgrasp {
namespace voxel_passes {

// Adds to each key the point's voxel number along one axis times that axis' stride.
BOXGRASP_SIMD void addKeys(const float* values, std::size_t n, double per_edge, double first,
                           std::int64_t stride, std::int64_t* keys) {
  for (std::size_t i = 0; i < n; ++i) {
    keys[i] += stride * static_cast<std::int32_t>(values[i] * per_edge + 0.5 - first);
  }
}

}  // namespace voxel_passes

namespace {

// Keys of 32 bits do for most clouds, in half the memory and time.
template <typename Key>
struct KeyedPoint {
  Key key;
  std::uint32_t index;
};

// The key of each point's voxel.
struct Keys {
  std::vector<std::int64_t> of_points;
  std::int64_t largest = 0, stride_y = 0, stride_z = 0;
};

Keys computeKeys(const PointCloud& cloud, double edge_m) {
  const Eigen::AlignedBox3d box = bounds(cloud);
  const double per_edge = 1.0 / std::max(edge_m, std::ldexp(box.sizes().maxCoeff(), -20));
  const std::vector<float>* const axes[] = {&cloud.x, &cloud.y, &cloud.z};
  std::vector<std::int64_t> keys(cloud.size(), 0);
  std::int64_t strides[4] = {1};
  for (int axis = 0; axis < 3; ++axis) {
    const double first = std::floor(box.min()[axis] * per_edge + 0.5);
    const double last = std::floor(box.max()[axis] * per_edge + 0.5);
    voxel_passes::addKeys(axes[axis]->data(), cloud.size(), per_edge, first, strides[axis], keys.data());
    strides[axis + 1] = strides[axis] * (static_cast<std::int64_t>(last - first) + 3);
  }
  const std::int64_t largest = *std::max_element(keys.begin(), keys.end());
  return {std::move(keys), largest, strides[1], strides[2]};
}

// Sorts by eleven bits of the key, keeping the order of equals.
template <typename Key>
void countingSort(const std::vector<KeyedPoint<Key>>& from, std::vector<KeyedPoint<Key>>& to, int shift) {
  constexpr std::size_t kBuckets = 1 << 11;
  std::array<std::uint32_t, kBuckets + 1> start{};
  for (const auto& point : from) ++start[(point.key >> shift) % kBuckets + 1];
  for (std::size_t i = 1; i < kBuckets; ++i) start[i] += start[i - 1];
  for (const auto& point : from) to[start[(point.key >> shift) % kBuckets]++] = point;
}

template <typename Key>
std::vector<KeyedPoint<Key>> sortedByKey(std::vector<std::int64_t> keys, std::int64_t largest) {
  std::vector<KeyedPoint<Key>> points(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    points[i] = {static_cast<Key>(keys[i]), static_cast<std::uint32_t>(i)};
  std::vector<std::int64_t>().swap(keys);  // a million points have 8 MB of them
  std::vector<KeyedPoint<Key>> sorted(points.size());
  for (int shift = 0; largest >> shift != 0; shift += 11) {
    countingSort(points, sorted, shift);
    points.swap(sorted);
  }
  return points;
}

template <typename Key>
void sortInto(Voxels& voxels, std::vector<std::int64_t> keys, std::int64_t largest) {
  const std::vector<KeyedPoint<Key>> points = sortedByKey<Key>(std::move(keys), largest);
  voxels.order.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    voxels.order[i] = points[i].index;
    if (i > 0 && points[i].key == points[i - 1].key) continue;
    voxels.begin.push_back(static_cast<std::uint32_t>(i));
    voxels.keys.push_back(static_cast<std::int64_t>(points[i].key));
  }
  voxels.begin.push_back(static_cast<std::uint32_t>(points.size()));
}

// The occupied voxels, and the empty ones around them.
class Occupancy {
 public:
  explicit Occupancy(const Keys& keys)
      : stride_y_(keys.stride_y),
        stride_z_(keys.stride_z),
        margin_(keys.stride_z + keys.stride_y + 1),
        occupied_(static_cast<std::size_t>(keys.largest + 2 * margin_ + 1)) {
    for (const std::int64_t key : keys.of_points) size_ += take(key, 0, 1);
  }

  std::size_t size() const { return size_; }

  // Takes out the voxels that hang together with this one, and returns how many they are.
  std::size_t takeConnected(std::int64_t first) {
    std::vector<std::int64_t> taken{first};
    take(first, 1, 0);
    for (std::size_t i = 0; i < taken.size(); ++i) {
      const std::int64_t key = taken[i];
      for (const std::int64_t layer : {key - stride_z_, key, key + stride_z_}) {
        for (const std::int64_t row : {layer - stride_y_, layer, layer + stride_y_}) {
          for (const std::int64_t neighbour : {row - 1, row, row + 1}) {
            if (take(neighbour, 1, 0)) taken.push_back(neighbour);
          }
        }
      }
    }
    return taken.size();
  }

 private:
  // Turns a voxel from one state into the other; whether it was in the one.
  bool take(std::int64_t key, char from, char to) {
    char& state = occupied_[static_cast<std::size_t>(key + margin_)];
    const bool was = state == from;
    if (was) state = to;
    return was;
  }

  std::int64_t stride_y_, stride_z_, margin_;
  std::vector<char> occupied_;
  std::size_t size_ = 0;
};

}  // namespace

Voxels sortIntoVoxels(const PointCloud& cloud, double edge_m) {
  assert(!cloud.empty() && edge_m > 0.0);
  Keys keys = computeKeys(cloud, edge_m);
  Voxels voxels;
  voxels.stride_y = keys.stride_y;
  voxels.stride_z = keys.stride_z;
  if (keys.largest <= std::numeric_limits<std::uint32_t>::max())
    sortInto<std::uint32_t>(voxels, std::move(keys.of_points), keys.largest);
  else
    sortInto<std::uint64_t>(voxels, std::move(keys.of_points), keys.largest);
  return voxels;
}

bool voxelsHangTogether(const PointCloud& cloud, double edge_m) {
  assert(!cloud.empty() && edge_m > 0.0);
  const Keys keys = computeKeys(cloud, edge_m);
  constexpr std::int64_t kLeast = 1 << 16;
  if (keys.largest > std::max(kLeast, static_cast<std::int64_t>(4 * cloud.size()))) return false;
  Occupancy occupied(keys);
  return occupied.takeConnected(keys.of_points.front()) == occupied.size();
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
