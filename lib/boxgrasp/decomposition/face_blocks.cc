#include "boxgrasp/decomposition/face_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "boxgrasp/base/ordered_bits.h"
#include "boxgrasp/base/simd.h"
#include "boxgrasp/decomposition/point_marks.h"

namespace boxgrasp {

namespace block_passes {

constexpr std::size_t kBlock = kPointBlock;
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

// How far each point of a block reaches out of a half plane.
BOXGRASP_SIMD void pointsOutOf(const float* x, const float* y, HalfPlane plane, float* reach) {
  for (std::size_t i = 0; i < kBlock; ++i)
    reach[i] = plane.normal_x * x[i] + plane.normal_y * y[i] - plane.offset;
}

// Marks those that reach out of it by more than a limit.
BOXGRASP_SIMD void markOutside(const float* x, const float* y, HalfPlane plane, float limit,
                               std::uint8_t* mark) {
  for (std::size_t i = 0; i < kBlock; ++i)
    mark[i] = plane.normal_x * x[i] + plane.normal_y * y[i] - plane.offset > limit;
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

}  // namespace block_passes

using block_passes::kBlock;
using block_passes::kInfinity;

namespace {

constexpr float kMargin = 1e-6f;  // of the face's size

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

FaceBlocks::FaceBlocks(const BlockedValues& x, const BlockedValues& y) : x_(x), y_(y) {
  for (const BlockedValues* coordinate : {&x_, &y_}) {
    const BlockRanges& ranges = coordinate->ranges();
    margin_ = std::max({margin_, std::abs(ranges.all.min), std::abs(ranges.all.max)});
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
  const HalfPlane plane{x, y, 0.0f};
  const std::vector<float> reach = reachOut({plane});
  float farthest = -kInfinity, values[kBlock];
  Vector2d point(0, 0);
  const auto look = [&](std::size_t block) {
    block_passes::pointsOutOf(x_.block(block), y_.block(block), plane, values);
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

std::vector<Vector2d> FaceBlocks::pointsOutside(const HalfPlane& plane) const {
  std::vector<Vector2d> points;
  PointMarks marks;
  for (const std::uint32_t block : placesAbove(reachOut({plane}), -margin_)) {
    const float *x = x_.block(block), *y = y_.block(block);
    block_passes::markOutside(x, y, plane, -margin_, marks.data());
    forEachMarked(marks, [&](std::size_t i) { points.emplace_back(x[i], y[i]); });
  }
  return points;
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
  for (const std::uint32_t block : blocks) {
    const float *x = x_.block(block), *y = y_.block(block);
    forEachMarked(openPoints(x, y, a, b, margin_), [&](std::size_t i) { points.emplace_back(x[i], y[i]); });
  }
}

void FaceBlocks::appendNearest(const std::vector<std::uint32_t>& blocks, const Line& line,
                               std::vector<Vector2d>& points) const {
  PointMarks marks;
  for (const std::uint32_t block : blocks) {
    const float *x = x_.block(block), *y = y_.block(block);
    block_passes::markNearest(x, y, line, marks.data());
    forEachMarked(marks, [&](std::size_t i) { points.emplace_back(x[i], y[i]); });
  }
}

}  // namespace boxgrasp
