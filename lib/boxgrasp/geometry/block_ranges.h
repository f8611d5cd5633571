// The ranges of values and of runs of them: what needs a look at few of many points asks them first.
#pragma once

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

// Of each block of values, the middle of its range and half the range's width.
struct BlockRanges {
  std::vector<float> middle, half;

  std::size_t size() const { return middle.size(); }
};

// Blocks are `block` values long, the last one perhaps shorter. Pre: the values are finite, and `block` is
// above 0.
BlockRanges blockRanges(std::span<const float> values, std::size_t block);

}  // namespace boxgrasp
