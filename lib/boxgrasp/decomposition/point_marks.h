// Passes over the points of a block that mark some of them.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "boxgrasp/decomposition/half_plane.h"

namespace boxgrasp {

// Points that a pass looks at together. In a face, a block is about as wide as the strip of points next to a
// cut.
inline constexpr std::size_t kPointBlock = 64;

using PointMarks = std::array<std::uint8_t, kPointBlock>;

// Marks the points of a block that are in the inside of neither of two regions, or nearer to an edge than a
// margin.
PointMarks openPoints(const float* x, const float* y, const Region& a, const Region& b, float margin);

// Calls the function with the place of each marked point. Made for few marks.
template <typename Function>
void forEachMarked(const PointMarks& marks, const Function& function) {
  for (std::size_t i = 0; i < kPointBlock; i += sizeof(std::uint64_t)) {
    std::uint64_t any;
    std::memcpy(&any, &marks[i], sizeof any);
    if (any == 0) continue;
    for (std::size_t k = i; k < i + sizeof any; ++k) {
      if (marks[k]) function(k);
    }
  }
}

}  // namespace boxgrasp
