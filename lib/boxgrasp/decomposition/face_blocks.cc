#include "boxgrasp/decomposition/face_blocks.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {

namespace block_passes {

constexpr std::size_t kBlock = 64;  // a block is about as wide as the strip of points next to a cut
constexpr std::size_t kLanes = 16;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// How far each rectangle reaches out of a region.
BOXGRASP_SIMD void reachOut(const float* x, const float* y, const float* half_x, const float* half_y,
                            std::size_t n, const HalfPlane* planes, std::size_t count, float* reach) {
  std::fill_n(reach, n, -kInfinity);
  for (std::size_t p = 0; p < count; ++p) {
    const float a = planes[p].normal_x, b = planes[p].normal_y, c = planes[p].offset;
    const float abs_a = std::abs(a), abs_b = std::abs(b);
    for (std::size_t i = 0; i < n; ++i) {
      const float out = a * x[i] + b * y[i] + (abs_a * half_x[i] + abs_b * half_y[i]) - c;
      reach[i] = out > reach[i] ? out : reach[i];
    }
  }
}

// How far each point of a block reaches out of a region.
inline void pointsOut(const float* x, const float* y, const HalfPlane* planes, std::size_t count,
                      float* reach) {
  for (std::size_t i = 0; i < kBlock; ++i) reach[i] = -kInfinity;
  for (std::size_t p = 0; p < count; ++p) {
    const float a = planes[p].normal_x, b = planes[p].normal_y, c = planes[p].offset;
    for (std::size_t i = 0; i < kBlock; ++i) {
      const float out = a * x[i] + b * y[i] - c;
      reach[i] = out > reach[i] ? out : reach[i];
    }
  }
}

// Marks the points of a block that reach out of both regions by more than a limit.
BOXGRASP_SIMD void markOpen(const float* x, const float* y, const HalfPlane* a, std::size_t count_a,
                            const HalfPlane* b, std::size_t count_b, float limit, std::uint8_t* mark) {
  float out_a[kBlock], out_b[kBlock];
  pointsOut(x, y, a, count_a, out_a);
  pointsOut(x, y, b, count_b, out_b);
  for (std::size_t i = 0; i < kBlock; ++i) mark[i] = (out_a[i] > limit) & (out_b[i] > limit);
}

// Marks the points of a block that are nearest to a line on its side.
BOXGRASP_SIMD void markNearest(const float* x, const float* y, Line line, std::uint8_t* mark) {
  float below[kLanes], above[kLanes], values[kBlock];
  for (std::size_t k = 0; k < kLanes; ++k) below[k] = -kInfinity, above[k] = kInfinity;
  for (std::size_t i = 0; i < kBlock; i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float value = line.normal_x * x[i + k] + line.normal_y * y[i + k];
      const float low = value <= line.offset ? value : -kInfinity;
      const float high = value <= line.offset ? kInfinity : value;
      values[i + k] = value;
      below[k] = low > below[k] ? low : below[k];
      above[k] = high < above[k] ? high : above[k];
    }
  }
  for (std::size_t width = kLanes / 2; width > 0; width /= 2) {
    for (std::size_t k = 0; k < width; ++k) {
      below[k] = below[k + width] > below[k] ? below[k + width] : below[k];
      above[k] = above[k + width] < above[k] ? above[k + width] : above[k];
    }
  }
  const float highest_below = below[0], lowest_above = above[0];
  for (std::size_t i = 0; i < kBlock; ++i)
    mark[i] = (values[i] == highest_below) | (values[i] == lowest_above);
}

// normal.p for the points of a block.
BOXGRASP_SIMD void valuesOf(const float* x, const float* y, float normal_x, float normal_y, float* values) {
  for (std::size_t i = 0; i < kBlock; ++i) values[i] = normal_x * x[i] + normal_y * y[i];
}

}  // namespace block_passes

using block_passes::kBlock;
using block_passes::kInfinity;

namespace {

constexpr float kMargin = 1e-6f;  // of the face's size: several rounding errors of a coordinate

void appendMarked(const float* x, const float* y, const std::uint8_t* mark, std::vector<Vector2d>& points) {
  for (std::size_t i = 0; i < kBlock; i += sizeof(std::uint64_t)) {
    std::uint64_t any;
    std::memcpy(&any, mark + i, sizeof any);
    if (any == 0) continue;
    for (std::size_t k = i; k < i + sizeof any; ++k) {
      if (mark[k]) points.emplace_back(x[k], y[k]);
    }
  }
}

}  // namespace

BlockedValues::BlockedValues(std::span<const float> coordinates) {
  const std::size_t whole = (coordinates.size() + kBlock - 1) / kBlock * kBlock;
  values.reserve(whole);
  values.assign(coordinates.begin(), coordinates.end());
  values.resize(whole, coordinates.back());
  ranges = blockRanges(values, kBlock);
}

FaceBlocks::FaceBlocks(const BlockedValues& x, const BlockedValues& y) : x_(x), y_(y) {
  for (const BlockedValues* coordinate : {&x_, &y_}) {
    const BlockRanges& ranges = coordinate->ranges;
    for (std::size_t b = 0; b < ranges.size(); ++b)
      margin_ = std::max(margin_, std::abs(ranges.middle[b]) + ranges.half[b]);
  }
  margin_ *= kMargin;
}

std::vector<float> FaceBlocks::reachOut(const Region& region) const {
  std::vector<float> reach(x_.ranges.size());
  block_passes::reachOut(x_.ranges.middle.data(), y_.ranges.middle.data(), x_.ranges.half.data(),
                         y_.ranges.half.data(), reach.size(), region.data(), region.size(), reach.data());
  return reach;
}

std::vector<Vector2d> FaceBlocks::spreadPoints(std::size_t count) const {
  const std::size_t step = (x_.values.size() + count - 1) / count;
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i < x_.values.size(); i += step) points.emplace_back(x_.values[i], y_.values[i]);
  return points;
}

Vector2d FaceBlocks::support(float x, float y) const {
  const HalfPlane beyond{x, y, 0.0f};
  const std::vector<float> reach = reachOut({beyond});
  const auto first = static_cast<std::size_t>(std::max_element(reach.begin(), reach.end()) - reach.begin());
  float farthest = -kInfinity, values[kBlock];
  std::size_t point = 0;
  const auto look = [&](std::size_t block) {
    block_passes::valuesOf(&x_.values[block * kBlock], &y_.values[block * kBlock], x, y, values);
    const float* best = std::max_element(values, values + kBlock);
    if (*best <= farthest) return;
    farthest = *best;
    point = block * kBlock + static_cast<std::size_t>(best - values);
  };
  look(first);
  for (std::size_t b = 0; b < reach.size(); ++b) {
    if (reach[b] > farthest) look(b);
  }
  return {x_.values[point], y_.values[point]};
}

std::vector<std::uint32_t> FaceBlocks::openBlocks(const Region& a, const Region& b) const {
  const std::vector<float> out_a = reachOut(a), out_b = reachOut(b);
  std::vector<std::uint32_t> open;
  for (std::size_t i = 0; i < out_a.size(); ++i) {
    if (std::min(out_a[i], out_b[i]) > -margin_) open.push_back(static_cast<std::uint32_t>(i));
  }
  return open;
}

void FaceBlocks::appendOpenPoints(const std::vector<std::uint32_t>& blocks, const Region& a, const Region& b,
                                  std::vector<Vector2d>& points) const {
  std::uint8_t mark[kBlock];
  for (const std::uint32_t block : blocks) {
    const float *x = &x_.values[block * kBlock], *y = &y_.values[block * kBlock];
    block_passes::markOpen(x, y, a.data(), a.size(), b.data(), b.size(), -margin_, mark);
    appendMarked(x, y, mark, points);
  }
}

void FaceBlocks::appendNearest(const std::vector<std::uint32_t>& blocks, const Line& line,
                               std::vector<Vector2d>& points) const {
  std::uint8_t mark[kBlock];
  for (const std::uint32_t block : blocks) {
    const float *x = &x_.values[block * kBlock], *y = &y_.values[block * kBlock];
    block_passes::markNearest(x, y, line, mark);
    appendMarked(x, y, mark, points);
  }
}

}  // namespace boxgrasp
