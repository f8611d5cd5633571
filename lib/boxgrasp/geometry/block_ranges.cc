#include "boxgrasp/geometry/block_ranges.h"

#include <algorithm>
#include <limits>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {

namespace range_passes {

constexpr std::size_t kLanes = 16;

BOXGRASP_SIMD ValueRange rangeOf(const float* values, std::size_t n) {
  float low[kLanes], high[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) low[k] = ValueRange{}.min, high[k] = ValueRange{}.max;
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
  return {low[0], high[0]};
}

}  // namespace range_passes

ValueRange rangeOf(std::span<const float> values) {
  return range_passes::rangeOf(values.data(), values.size());
}

BlockRanges blockRanges(std::span<const float> values, std::size_t block) {
  BlockRanges ranges;
  for (std::size_t begin = 0; begin < values.size(); begin += block) {
    const ValueRange range = rangeOf(values.subspan(begin, std::min(block, values.size() - begin)));
    ranges.middle.push_back(0.5f * range.min + 0.5f * range.max);
    ranges.half.push_back(0.5f * range.max - 0.5f * range.min);
  }
  return ranges;
}

}  // namespace boxgrasp
