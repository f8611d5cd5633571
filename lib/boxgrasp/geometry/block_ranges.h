// The ranges of values and of runs of them: what needs a look at few of many points asks them first.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace boxgrasp {

struct ValueRange {
  float min = std::numeric_limits<float>::infinity();
  float max = -std::numeric_limits<float>::infinity();
};

// The smallest and the largest of the values; of none the empty range.
ValueRange rangeOf(std::span<const float> values);

// Of each block of values, the middle of its range and half the range's width; and the range of all values.
struct BlockRanges {
  std::vector<float> middle, half;
  ValueRange all;

  std::size_t size() const { return middle.size(); }
};

// Blocks are `block` values long, the last one perhaps shorter. Pre: the values are finite, and `block` is
// above 0.
BlockRanges blockRanges(std::span<const float> values, std::size_t block);

// The first place of a value; 0 if it is nowhere, as where coordinates near the largest float overflow.
std::size_t placeOf(float value, std::span<const float> values);

// The places of the values above a limit, in ascending order: fast where there are few.
std::vector<std::uint32_t> placesAbove(std::span<const float> values, float limit);

}  // namespace boxgrasp
