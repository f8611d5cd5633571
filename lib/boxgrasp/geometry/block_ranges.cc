#include "boxgrasp/geometry/block_ranges.h"

#include <algorithm>
#include <limits>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {

namespace block_range_passes {

constexpr std::size_t kLanes = 16;

BOXGRASP_SIMD void range(const float* values, std::size_t n, float& middle, float& half) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  float low[kLanes], high[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) low[k] = kInfinity, high[k] = -kInfinity;
  const std::size_t whole = n - n % kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      low[k] = values[i + k] < low[k] ? values[i + k] : low[k];
      high[k] = values[i + k] > high[k] ? values[i + k] : high[k];
    }
  }
  for (std::size_t i = whole; i < n; ++i) {
    low[0] = values[i] < low[0] ? values[i] : low[0];
    high[0] = values[i] > high[0] ? values[i] : high[0];
  }
  for (std::size_t width = kLanes / 2; width > 0; width /= 2) {
    for (std::size_t k = 0; k < width; ++k) {
      low[k] = low[k + width] < low[k] ? low[k + width] : low[k];
      high[k] = high[k + width] > high[k] ? high[k + width] : high[k];
    }
  }
  middle = 0.5f * low[0] + 0.5f * high[0];
  half = 0.5f * high[0] - 0.5f * low[0];
}

}  // namespace block_range_passes

BlockRanges blockRanges(std::span<const float> values, std::size_t block) {
  BlockRanges ranges;
  const std::size_t count = (values.size() + block - 1) / block;
  ranges.middle.resize(count);
  ranges.half.resize(count);
  for (std::size_t b = 0; b < count; ++b) {
    block_range_passes::range(values.data() + b * block, std::min(block, values.size() - b * block),
                              ranges.middle[b], ranges.half[b]);
  }
  return ranges;
}

}  // namespace boxgrasp
