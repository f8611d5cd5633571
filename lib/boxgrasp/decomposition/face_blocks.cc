#include "boxgrasp/decomposition/face_blocks.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "boxgrasp/base/ordered_bits.h"
#include "boxgrasp/base/simd.h"

namespace boxgrasp {

namespace block_passes {

constexpr std::size_t kBlock = 64;  // a block is about as wide as the strip of points next to a cut
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
BOXGRASP_SIMD_PART void pointsOut(const float* x, const float* y, const HalfPlane* planes, std::size_t count,
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
  float values[kBlock];
  std::int32_t below = orderedBits(-kInfinity), above = orderedBits(kInfinity);
  for (std::size_t i = 0; i < kBlock; ++i) {
    values[i] = line.normal_x * x[i] + line.normal_y * y[i];
    const std::int32_t low = orderedBits(values[i] <= line.offset ? values[i] : -kInfinity);
    const std::int32_t high = orderedBits(values[i] <= line.offset ? kInfinity : values[i]);
    below = low > below ? low : below;
    above = high < above ? high : above;
  }
  const float highest_below = fromOrderedBits(below), lowest_above = fromOrderedBits(above);
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

BlockedValues::BlockedValues(std::span<const float> coordinates)
    : values_(coordinates), ranges_(blockRanges(coordinates, kBlock)) {
  const std::span<const float> rest = coordinates.subspan((ranges_.size() - 1) * kBlock);
  last_.assign(rest.begin(), rest.end());
  last_.resize(kBlock, rest.back());
}

const float* BlockedValues::block(std::size_t index) const {
  return index + 1 < ranges_.size() ? &values_[index * kBlock] : last_.data();
}

void PointPool::add(const Vector2d& p) {
  const auto x = static_cast<float>(p.x()), y = static_cast<float>(p.y());
  if (size_ == x_.size()) {
    x_.resize(size_ + kBlock, x);
    y_.resize(size_ + kBlock, y);
  }
  x_[size_] = x;
  y_[size_] = y;
  ++size_;
}

std::size_t PointPool::blocks() const { return x_.size() / kBlock; }
const float* PointPool::x(std::size_t block) const { return &x_[block * kBlock]; }
const float* PointPool::y(std::size_t block) const { return &y_[block * kBlock]; }

FaceBlocks::FaceBlocks(const BlockedValues& x, const BlockedValues& y) : x_(x), y_(y) {
  for (const BlockedValues* coordinate : {&x_, &y_}) {
    const BlockRanges& ranges = coordinate->ranges();
    for (std::size_t b = 0; b < ranges.size(); ++b)
      margin_ = std::max(margin_, std::abs(ranges.middle[b]) + ranges.half[b]);
  }
  margin_ *= kMargin;
}

std::vector<float> FaceBlocks::reachOut(const Region& region) const {
  std::vector<float> reach(x_.ranges().size());
  block_passes::reachOut(x_.ranges().middle.data(), y_.ranges().middle.data(), x_.ranges().half.data(),
                         y_.ranges().half.data(), reach.size(), region.data(), region.size(), reach.data());
  return reach;
}

std::vector<Vector2d> FaceBlocks::spreadPoints(std::size_t count) const {
  const std::span<const float> x = x_.values(), y = y_.values();
  const std::size_t step = (x.size() + count - 1) / count;
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i < x.size(); i += step) points.emplace_back(x[i], y[i]);
  return points;
}

Vector2d FaceBlocks::support(float x, float y) const {
  const std::vector<float> reach = reachOut({{x, y, 0.0f}});
  float farthest = -kInfinity, values[kBlock];
  Vector2d point(0, 0);
  const auto look = [&](std::size_t block) {
    block_passes::valuesOf(x_.block(block), y_.block(block), x, y, values);
    const float best = rangeOf(values).max;
    if (best <= farthest) return;
    farthest = best;
    const std::size_t place = placeOf(best, values);
    point = {x_.block(block)[place], y_.block(block)[place]};
  };
  look(placeOf(rangeOf(reach).max, reach));
  for (const std::uint32_t block : placesAbove(reach, farthest)) {
    if (reach[block] > farthest) look(block);
  }
  return point;
}

std::vector<std::uint32_t> FaceBlocks::openBlocks(const Region& a, const Region& b) const {
  std::vector<float> out = reachOut(a);
  const std::vector<float> out_b = reachOut(b);
  std::transform(out.begin(), out.end(), out_b.begin(), out.begin(),
                 [](float i, float k) { return i < k ? i : k; });
  return placesAbove(out, -margin_);
}

void FaceBlocks::appendOpenPoints(const std::vector<std::uint32_t>& blocks, const Region& a, const Region& b,
                                  std::vector<Vector2d>& points) const {
  std::uint8_t mark[kBlock];
  for (const std::uint32_t block : blocks) {
    const float *x = x_.block(block), *y = y_.block(block);
    block_passes::markOpen(x, y, a.data(), a.size(), b.data(), b.size(), -margin_, mark);
    appendMarked(x, y, mark, points);
  }
}

void FaceBlocks::appendOpenPoints(const PointPool& pool, const Region& a, const Region& b,
                                  std::vector<Vector2d>& points) const {
  std::uint8_t mark[kBlock];
  for (std::size_t block = 0; block < pool.blocks(); ++block) {
    const float *x = pool.x(block), *y = pool.y(block);
    block_passes::markOpen(x, y, a.data(), a.size(), b.data(), b.size(), -margin_, mark);
    appendMarked(x, y, mark, points);
  }
}

void FaceBlocks::appendNearest(const std::vector<std::uint32_t>& blocks, const Line& line,
                               std::vector<Vector2d>& points) const {
  std::uint8_t mark[kBlock];
  for (const std::uint32_t block : blocks) {
    const float *x = x_.block(block), *y = y_.block(block);
    block_passes::markNearest(x, y, line, mark);
    appendMarked(x, y, mark, points);
  }
}

}  // namespace boxgrasp
