#include "boxgrasp/geometry/support_points.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <tuple>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {

namespace support_passes {

constexpr std::size_t kLanes = 16;
constexpr std::size_t kBlock = 256;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Values are measured from an origin along a direction.
struct Axis {
  float origin[3];
  float direction[3];
};

inline float valueAlong(const Axis& axis, float x, float y, float z) {
  return axis.direction[0] * (x - axis.origin[0]) + axis.direction[1] * (y - axis.origin[1]) +
         axis.direction[2] * (z - axis.origin[2]);
}

BOXGRASP_SIMD ValueRange rangeAlong(const float* px, const float* py, const float* pz, std::size_t n,
                                    const Axis& along) {
  const Axis axis = along;
  float low[kLanes], high[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) low[k] = kInfinity, high[k] = -kInfinity;
  const std::size_t whole = n - n % kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float value = valueAlong(axis, px[i + k], py[i + k], pz[i + k]);
      low[k] = value < low[k] ? value : low[k];
      high[k] = value > high[k] ? value : high[k];
    }
  }
  for (std::size_t i = whole; i < n; ++i) {
    const float value = valueAlong(axis, px[i], py[i], pz[i]);
    low[0] = value < low[0] ? value : low[0];
    high[0] = value > high[0] ? value : high[0];
  }
  for (std::size_t width = kLanes / 2; width > 0; width /= 2) {
    for (std::size_t k = 0; k < width; ++k) {
      low[k] = low[k + width] < low[k] ? low[k + width] : low[k];
      high[k] = high[k + width] > high[k] ? high[k + width] : high[k];
    }
  }
  return {low[0], high[0]};
}

BOXGRASP_SIMD void valuesOf(const float* px, const float* py, const float* pz, std::size_t n,
                            const Axis& along, float* values) {
  const Axis axis = along;
  for (std::size_t i = 0; i < n; ++i) values[i] = valueAlong(axis, px[i], py[i], pz[i]);
}

// The least and the largest value that a point of each block can have, but for rounding.
BOXGRASP_SIMD void boundBlocks(const float* const* middle, const float* const* half, std::size_t blocks,
                               const Axis& along, float* low, float* high) {
  const Axis axis = along;
  const float *const half_x = half[0], *const half_y = half[1], *const half_z = half[2];
  for (std::size_t b = 0; b < blocks; ++b) {
    const float value = valueAlong(axis, middle[0][b], middle[1][b], middle[2][b]);
    const float reach = std::abs(axis.direction[0]) * half_x[b] + std::abs(axis.direction[1]) * half_y[b] +
                        std::abs(axis.direction[2]) * half_z[b];
    low[b] = value - reach;
    high[b] = value + reach;
  }
}

}  // namespace support_passes

namespace {

using support_passes::Axis;
using support_passes::kBlock;
using support_passes::kInfinity;

constexpr double kRounding =
    16.0 * std::numeric_limits<float>::epsilon();  // of a value, relative to the coordinates

Axis axisOf(const Vector3d& origin, const Vector3d& direction) {
  Axis axis;
  for (int i = 0; i < 3; ++i) {
    axis.origin[i] = static_cast<float>(origin[i]);
    axis.direction[i] = static_cast<float>(direction[i]);
  }
  return axis;
}

// Remembers the point of smallest coordinates among those shown.
struct Smallest {
  std::tuple<float, float, float> point{kInfinity, 0.0f, 0.0f};
  void show(float x, float y, float z) { point = std::min(point, std::make_tuple(x, y, z)); }
};

void append(const Smallest& smallest, PointCloud& found) {
  const auto& [x, y, z] = smallest.point;
  found.push({x, y, z});
}

// The search along one axis; blocks may be looked at in any order, some not at all.
class Extremes {
 public:
  Extremes(const PointCloud& cloud, const Axis& axis, std::size_t blocks)
      : cloud_(cloud), axis_(axis), low_(blocks), high_(blocks), ranges_(blocks) {}

  void bound(const std::array<const float*, 3>& middle, const std::array<const float*, 3>& half,
             float margin) {
    support_passes::boundBlocks(middle.data(), half.data(), ranges_.size(), axis_, low_.data(), high_.data());
    margin_ = margin;
    look(static_cast<std::size_t>(std::min_element(low_.begin(), low_.end()) - low_.begin()));
    look(static_cast<std::size_t>(std::max_element(high_.begin(), high_.end()) - high_.begin()));
  }

  // Whether the block can hold an outermost point.
  bool matters(std::size_t block) const {
    return !(low_[block] - margin_ > all_.min && high_[block] + margin_ < all_.max);
  }

  void look(std::size_t block) {
    const std::size_t begin = block * kBlock;
    const ValueRange range = support_passes::rangeAlong(&cloud_.x[begin], &cloud_.y[begin], &cloud_.z[begin],
                                                        sizeOf(block), axis_);
    ranges_[block] = range;
    all_.min = std::min(all_.min, range.min);
    all_.max = std::max(all_.max, range.max);
  }

  void append(PointCloud& found) const {
    Smallest lowest, highest;
    for (std::size_t b = 0; b < ranges_.size(); ++b) {
      if (ranges_[b].min == all_.min || ranges_[b].max == all_.max) show(b, lowest, highest);
    }
    boxgrasp::append(lowest, found);
    boxgrasp::append(highest, found);
  }

 private:
  std::size_t sizeOf(std::size_t block) const { return std::min(kBlock, cloud_.size() - block * kBlock); }

  void show(std::size_t block, Smallest& lowest, Smallest& highest) const {
    const std::size_t begin = block * kBlock, n = sizeOf(block);
    float values[kBlock];
    support_passes::valuesOf(&cloud_.x[begin], &cloud_.y[begin], &cloud_.z[begin], n, axis_, values);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t at = begin + i;
      if (values[i] == all_.min) lowest.show(cloud_.x[at], cloud_.y[at], cloud_.z[at]);
      if (values[i] == all_.max) highest.show(cloud_.x[at], cloud_.y[at], cloud_.z[at]);
    }
  }

  const PointCloud& cloud_;
  Axis axis_;
  float margin_ = 0.0f;
  std::vector<float> low_, high_;   // bounds
  std::vector<ValueRange> ranges_;  // of the blocks that were looked at
  ValueRange all_;
};

}  // namespace

SupportPoints::SupportPoints(const PointCloud& cloud)
    : cloud_(cloud),
      x_(blockRanges(cloud.x, kBlock)),
      y_(blockRanges(cloud.y, kBlock)),
      z_(blockRanges(cloud.z, kBlock)) {
  assert(!cloud.empty());
  for (const BlockRanges* ranges : {&x_, &y_, &z_}) {
    for (std::size_t b = 0; b < ranges->size(); ++b)
      reach_ = std::max(reach_, static_cast<double>(std::abs(ranges->middle[b]) + ranges->half[b]));
  }
}

void SupportPoints::append(const Vector3d& origin, const Matrix3d& directions, PointCloud& found) const {
  const std::array middle{x_.middle.data(), y_.middle.data(), z_.middle.data()};
  const std::array half{x_.half.data(), y_.half.data(), z_.half.data()};
  const auto margin = static_cast<float>(kRounding * (reach_ + origin.lpNorm<1>()));
  std::vector<Extremes> axes;
  for (int i = 0; i < 3; ++i) {
    axes.emplace_back(cloud_, axisOf(origin, directions.col(i)), x_.size());
    axes.back().bound(middle, half, margin);
  }
  for (std::size_t b = 0; b < x_.size(); ++b) {
    for (Extremes& axis : axes) {
      if (axis.matters(b)) axis.look(b);
    }
  }
  for (const Extremes& axis : axes) axis.append(found);
}

}  // namespace boxgrasp
