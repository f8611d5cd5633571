// Floats as integers of the same order. The least and the largest of many integers are the same in whatever
// order they are compared, and nothing is special about any of them: so compilers find them in vectors, which
// they may not do for floats.
#pragma once

#include <bit>
#include <cstdint>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {

// a < b gives orderedBits(a) < orderedBits(b); -0 comes before 0. Pre: not NaN.
BOXGRASP_SIMD_PART std::int32_t orderedBits(float value) {
  const auto bits = std::bit_cast<std::int32_t>(value);
  return bits ^ ((bits >> 31) & 0x7fffffff);
}

BOXGRASP_SIMD_PART float fromOrderedBits(std::int32_t bits) {
  return std::bit_cast<float>(bits ^ ((bits >> 31) & 0x7fffffff));
}

}  // namespace boxgrasp
