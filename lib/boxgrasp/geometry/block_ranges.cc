#include "boxgrasp/geometry/block_ranges.h"

#include <algorithm>
#include <limits>

#include "boxgrasp/base/ordered_bits.h"
#include "boxgrasp/base/simd.h"

namespace boxgrasp {

namespace range_passes {

constexpr std::size_t kLanes = 32;

BOXGRASP_SIMD_PART ValueRange rangeOf(const float* values, std::size_t n) {
  std::int32_t low = orderedBits(ValueRange{}.min), high = orderedBits(ValueRange{}.max);
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t value = orderedBits(values[i]);
    low = value < low ? value : low;
    high = value > high ? value : high;
  }
  return {fromOrderedBits(low), fromOrderedBits(high)};
}

BOXGRASP_SIMD void rangeOfAll(const float* values, std::size_t n, ValueRange& range) {
  range = rangeOf(values, n);
}

BOXGRASP_SIMD void rangesOfBlocks(const float* values, std::size_t n, std::size_t block,
                                  BlockRanges& ranges) {
  for (std::size_t begin = 0, b = 0; begin < n; begin += block, ++b) {
    const ValueRange range = rangeOf(values + begin, std::min(block, n - begin));
    ranges.middle[b] = 0.5f * range.min + 0.5f * range.max;
    ranges.half[b] = 0.5f * range.max - 0.5f * range.min;
    ranges.all.min = std::min(ranges.all.min, range.min);
    ranges.all.max = std::max(ranges.all.max, range.max);
  }
}

// The first place of a value; n if there is none.
BOXGRASP_SIMD std::size_t firstPlace(const float* values, std::size_t n, float value) {
  auto place = static_cast<std::int32_t>(n);
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(n); ++i) {
    const std::int32_t here = values[i] == value ? i : static_cast<std::int32_t>(n);
    place = here < place ? here : place;
  }
  return static_cast<std::size_t>(place);
}

// Writes the places of the values above a limit, and returns how many there are; writes to one place more.
BOXGRASP_SIMD std::size_t placesAbove(const float* values, std::size_t n, float limit,
                                      std::uint32_t* places) {
  std::size_t count = 0;
  const auto look = [&](std::size_t i) {
    places[count] = static_cast<std::uint32_t>(i);
    count += values[i] > limit ? 1 : 0;
  };
  const std::size_t whole = n - n % kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes) {
    std::uint32_t any = 0;
    for (std::size_t k = 0; k < kLanes; ++k) any |= values[i + k] > limit ? 1u : 0u;
    if (any == 0) continue;
    for (std::size_t k = 0; k < kLanes; ++k) look(i + k);
  }
  for (std::size_t i = whole; i < n; ++i) look(i);
  return count;
}

}  // namespace range_passes

ValueRange rangeOf(std::span<const float> values) {
  ValueRange range;
  range_passes::rangeOfAll(values.data(), values.size(), range);
  return range;
}

BlockRanges blockRanges(std::span<const float> values, std::size_t block) {
  const std::size_t count = (values.size() + block - 1) / block;
  BlockRanges ranges{std::vector<float>(count), std::vector<float>(count), {}};
  range_passes::rangesOfBlocks(values.data(), values.size(), block, ranges);
  return ranges;
}

std::size_t placeOf(float value, std::span<const float> values) {
  const std::size_t place = range_passes::firstPlace(values.data(), values.size(), value);
  return place == values.size() ? 0 : place;
}

std::vector<std::uint32_t> placesAbove(std::span<const float> values, float limit) {
  std::vector<std::uint32_t> places(values.size() + 1);
  places.resize(range_passes::placesAbove(values.data(), values.size(), limit, places.data()));
  return places;
}

}  // namespace boxgrasp
