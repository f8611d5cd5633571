// The ranges of runs of values: what needs a look at few of many points asks them first.
#pragma once

#include <span>
#include <vector>

namespace boxgrasp {

// Of each block of values, the middle of its range and half the range's width.
struct BlockRanges {
  std::vector<float> middle, half;

  std::size_t size() const { return middle.size(); }
};

// Blocks are `block` values long, the last one perhaps shorter. Pre: the values are finite, and `block` is
// above 0.
BlockRanges blockRanges(std::span<const float> values, std::size_t block);

}  // namespace boxgrasp
