#include "boxgrasp/decomposition/point_pool.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "boxgrasp/base/simd.h"
#include "boxgrasp/decomposition/point_marks.h"

namespace boxgrasp {

namespace point_pool_passes {

constexpr std::int32_t kNone = -1;
constexpr std::size_t kMostAtOnce = 512;

// How far a point is beyond a half plane as an integer, for positive floats are ordered as those; kNone for
// one that is not beyond it, or not on a side.
BOXGRASP_SIMD_PART std::int32_t keyOf(float x, float y, const HalfPlane& inside, const HalfPlane& side) {
  const float out = inside.normal_x * x + inside.normal_y * y - inside.offset;
  const bool counts = (out > 0.0f) & (side.normal_x * x + side.normal_y * y <= side.offset);
  return counts ? std::bit_cast<std::int32_t>(out) : kNone;
}

// The place of the first point with the greatest key; n where no point has one. Pre: whole blocks, n is at
// most kMostAtOnce.
BOXGRASP_SIMD std::size_t farthestBeyond(const float* x, const float* y, std::size_t n,
                                         const HalfPlane& inside, const HalfPlane& side) {
  const HalfPlane in = inside, on = side;
  std::int32_t keys[kMostAtOnce], greatest = kNone;
  for (std::size_t i = 0; i < n; ++i) {
    keys[i] = keyOf(x[i], y[i], in, on);
    greatest = keys[i] > greatest ? keys[i] : greatest;
  }
  if (greatest == kNone) return n;
  for (std::size_t begin = 0; begin < n; begin += kPointBlock) {
    std::int32_t is_here = 0;
    for (std::size_t i = begin; i < begin + kPointBlock; ++i) is_here |= keys[i] == greatest ? 1 : 0;
    if (is_here == 0) continue;
    return static_cast<std::size_t>(std::find(keys + begin, keys + n, greatest) - keys);
  }
  return n;
}

}  // namespace point_pool_passes

using point_pool_passes::kMostAtOnce;

PointPool::PointPool(const std::vector<Vector2d>& points) {
  for (const Vector2d& p : points) add(p);
}

void PointPool::add(const Vector2d& p) {
  const auto x = static_cast<float>(p.x()), y = static_cast<float>(p.y());
  if (size_ == x_.size()) {
    x_.resize(size_ + kPointBlock, x);
    y_.resize(size_ + kPointBlock, y);
  }
  x_[size_] = x;
  y_[size_] = y;
  ++size_;
}

std::optional<Vector2d> PointPool::farthestBeyond(const HalfPlane& inside, const HalfPlane& side) const {
  std::optional<Vector2d> farthest;
  HalfPlane beyond = inside;
  for (std::size_t begin = 0; begin < x_.size(); begin += kMostAtOnce) {
    const std::size_t n = std::min(kMostAtOnce, x_.size() - begin);
    const std::size_t place = point_pool_passes::farthestBeyond(&x_[begin], &y_[begin], n, beyond, side);
    if (place == n) continue;
    const float x = x_[begin + place], y = y_[begin + place];
    farthest = Vector2d(x, y);
    beyond.offset = inside.normal_x * x + inside.normal_y * y;
  }
  return farthest;
}

void PointPool::appendOpenPoints(const Region& a, const Region& b, float margin,
                                 std::vector<Vector2d>& points) const {
  for (std::size_t begin = 0; begin < size_; begin += kPointBlock) {
    const PointMarks marks = openPoints(&x_[begin], &y_[begin], a, b, margin);
    const std::size_t count = std::min(kPointBlock, size_ - begin);
    forEachMarked(marks, [&](std::size_t i) {
      if (i < count) points.emplace_back(x_[begin + i], y_[begin + i]);
    });
  }
}

}  // namespace boxgrasp
