// Passes over the points of a block that mark some of them.
#pragma once

#include <array>
#include <cstdint>

#include "boxgrasp/base/marks.h"
#include "boxgrasp/decomposition/half_plane.h"

namespace boxgrasp {

// Points that a pass looks at together. In a face, a block is about as wide as the strip of points next to a
// cut.
inline constexpr std::size_t kPointBlock = 64;

using PointMarks = std::array<std::uint8_t, kPointBlock>;

// Marks the points of a block that are in the inside of neither of two regions, or nearer to an edge than a
// margin.
PointMarks openPoints(const float* x, const float* y, const Region& a, const Region& b, float margin);

}  // namespace boxgrasp
