#include "boxgrasp/geometry/support_points.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <limits>
#include <tuple>

#include "boxgrasp/base/marks.h"
#include "boxgrasp/base/ordered_bits.h"
#include "boxgrasp/base/simd.h"

namespace boxgrasp {

namespace support_passes {

constexpr std::size_t kBlock = 128;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Values are measured from an origin along a direction.
struct Axis {
  float origin[3];
  float direction[3];
};

BOXGRASP_SIMD_PART float valueAlong(const Axis& axis, float x, float y, float z) {
  return axis.direction[0] * (x - axis.origin[0]) + axis.direction[1] * (y - axis.origin[1]) +
         axis.direction[2] * (z - axis.origin[2]);
}

BOXGRASP_SIMD ValueRange rangeAlong(const float* px, const float* py, const float* pz, std::size_t n,
                                    const Axis& along) {
  const Axis axis = along;
  std::int32_t low = orderedBits(kInfinity), high = orderedBits(-kInfinity);
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t value = orderedBits(valueAlong(axis, px[i], py[i], pz[i]));
    low = value < low ? value : low;
    high = value > high ? value : high;
  }
  return {fromOrderedBits(low), fromOrderedBits(high)};
}

constexpr std::uint8_t kLeast = 1, kGreatest = 2;

// Marks the points that have the least value of a range, or the greatest.
BOXGRASP_SIMD void markEnds(const float* px, const float* py, const float* pz, std::size_t n,
                            const Axis& along, ValueRange range, std::uint8_t* __restrict marks) {
  const Axis axis = along;
  for (std::size_t i = 0; i < n; ++i) {
    const float value = valueAlong(axis, px[i], py[i], pz[i]);
    marks[i] =
        static_cast<std::uint8_t>((value == range.min ? kLeast : 0) | (value == range.max ? kGreatest : 0));
  }
}

// The least and the largest value that a point of each block can have, but for rounding.
BOXGRASP_SIMD void boundBlocks(const float* const* middle, const float* const* half, std::size_t blocks,
                               const Axis& along, float* __restrict low, float* __restrict high) {
  const Axis axis = along;
  const float *const middle_x = middle[0], *const middle_y = middle[1], *const middle_z = middle[2];
  const float *const half_x = half[0], *const half_y = half[1], *const half_z = half[2];
  for (std::size_t b = 0; b < blocks; ++b) {
    const float value = valueAlong(axis, middle_x[b], middle_y[b], middle_z[b]);
    const float reach = std::abs(axis.direction[0]) * half_x[b] + std::abs(axis.direction[1]) * half_y[b] +
                        std::abs(axis.direction[2]) * half_z[b];
    low[b] = value - reach;
    high[b] = value + reach;
  }
}

// How far the values of each block can reach out of a range.
BOXGRASP_SIMD void reachOut(const float* low, const float* high, std::size_t blocks, ValueRange range,
                            float* reach) {
  for (std::size_t b = 0; b < blocks; ++b) {
    const float above = high[b] - range.max, below = range.min - low[b];
    reach[b] = above > below ? above : below;
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

// What is known of each block along an axis. Its memory serves for many axes.
struct BlockBounds {
  explicit BlockBounds(std::size_t blocks) : low(blocks), high(blocks), reach(blocks) {}
  std::vector<float> low, high, reach;
};

// The search along one axis. Blocks that cannot hold an outermost point are not looked at.
class Extremes {
 public:
  // Values may be wrong by a third of the margin.
  Extremes(const PointCloud& cloud, const std::array<BlockRanges, 3>& coordinates, const Axis& axis,
           float margin, BlockBounds& bounds)
      : cloud_(cloud), axis_(axis) {
    const auto& [x, y, z] = coordinates;
    const std::array middle{x.middle.data(), y.middle.data(), z.middle.data()};
    const std::array half{x.half.data(), y.half.data(), z.half.data()};
    const std::size_t blocks = x.size();
    auto& [low, high, reach] = bounds;
    support_passes::boundBlocks(middle.data(), half.data(), blocks, axis_, low.data(), high.data());
    const std::size_t lowest = placeOf(rangeOf(low).min, low), highest = placeOf(rangeOf(high).max, high);
    look(lowest);
    look(highest);
    support_passes::reachOut(low.data(), high.data(), blocks, all_, reach.data());
    for (const std::uint32_t block : placesAbove(reach, -margin)) {
      const bool matters = low[block] - margin <= all_.min || high[block] + margin >= all_.max;
      if (matters && block != lowest && block != highest) look(block);
    }
  }

  // Calls the function with the beginning and the end of each block that was looked at.
  template <typename Function>
  void forEachBlock(const Function& function) const {
    for (const auto& [block, range] : looked_at_) function(block * kBlock, block * kBlock + sizeOf(block));
  }

  void append(PointCloud& found) const {
    Smallest lowest, highest;
    for (const auto& [block, range] : looked_at_) {
      if (range.min == all_.min || range.max == all_.max) show(block, lowest, highest);
    }
    boxgrasp::append(lowest, found);
    boxgrasp::append(highest, found);
  }

 private:
  std::size_t sizeOf(std::size_t block) const { return std::min(kBlock, cloud_.size() - block * kBlock); }

  void look(std::size_t block) {
    const std::size_t begin = block * kBlock;
    const ValueRange range = support_passes::rangeAlong(&cloud_.x[begin], &cloud_.y[begin], &cloud_.z[begin],
                                                        sizeOf(block), axis_);
    looked_at_.emplace_back(block, range);
    all_.min = std::min(all_.min, range.min);
    all_.max = std::max(all_.max, range.max);
  }

  void show(std::size_t block, Smallest& lowest, Smallest& highest) const {
    const std::size_t begin = block * kBlock, n = sizeOf(block);
    std::uint8_t marks[kBlock];
    support_passes::markEnds(&cloud_.x[begin], &cloud_.y[begin], &cloud_.z[begin], n, axis_, all_, marks);
    forEachMarked({marks, n}, [&](std::size_t i) {
      const std::size_t at = begin + i;
      if (marks[i] & support_passes::kLeast) lowest.show(cloud_.x[at], cloud_.y[at], cloud_.z[at]);
      if (marks[i] & support_passes::kGreatest) highest.show(cloud_.x[at], cloud_.y[at], cloud_.z[at]);
    });
  }

  const PointCloud& cloud_;
  Axis axis_;
  std::vector<std::pair<std::size_t, ValueRange>> looked_at_;  // blocks
  ValueRange all_;
};

}  // namespace

SupportPoints::SupportPoints(const PointCloud& cloud)
    : cloud_(cloud),
      coordinates_{blockRanges(cloud.x, kBlock), blockRanges(cloud.y, kBlock), blockRanges(cloud.z, kBlock)} {
  assert(!cloud.empty());
  for (const BlockRanges& ranges : coordinates_)
    reach_ = std::max({reach_, static_cast<double>(-ranges.all.min), static_cast<double>(ranges.all.max)});
}

void SupportPoints::append(const Vector3d& origin, const std::vector<Vector3d>& directions,
                           PointCloud& found) const {
  const auto margin = static_cast<float>(kRounding * (reach_ + origin.lpNorm<1>()));
  BlockBounds bounds(coordinates_[0].size());
  for (const Vector3d& direction : directions)
    Extremes(cloud_, coordinates_, axisOf(origin, direction), margin, bounds).append(found);
}

Eigen::AlignedBox3d SupportPoints::bounds() const {
  const auto& [x, y, z] = coordinates_;
  return {Vector3d(x.all.min, y.all.min, z.all.min), Vector3d(x.all.max, y.all.max, z.all.max)};
}

AxisRanges SupportPoints::ranges(const Matrix3d& axes) const {
  const auto margin = static_cast<float>(2.0 * kRounding * reach_);  // the axes themselves are rounded, too
  BlockBounds bounds(coordinates_[0].size());
  AxisRanges ranges;
  for (int i = 0; i < 3; ++i) {
    const Extremes extremes(cloud_, coordinates_, axisOf({0, 0, 0}, axes.col(i)), margin, bounds);
    Interval all;
    extremes.forEachBlock([&](std::size_t begin, std::size_t end) {
      const Interval range = rangeAlong(cloud_, begin, end, axes.col(i));
      all.min = std::min(all.min, range.min);
      all.max = std::max(all.max, range.max);
    });
    ranges.min[i] = all.min;
    ranges.max[i] = all.max;
  }
  return ranges;
}

}  // namespace boxgrasp
