#include "boxgrasp/decomposition/point_marks.h"

#include <limits>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {

namespace mark_passes {

// How far each point of a block reaches out of a region.
BOXGRASP_SIMD_PART void pointsOut(const float* x, const float* y, const HalfPlane* planes, std::size_t count,
                                  float* reach) {
  for (std::size_t i = 0; i < kPointBlock; ++i) reach[i] = -std::numeric_limits<float>::infinity();
  for (std::size_t p = 0; p < count; ++p) {
    const float a = planes[p].normal_x, b = planes[p].normal_y, c = planes[p].offset;
    for (std::size_t i = 0; i < kPointBlock; ++i) {
      const float out = a * x[i] + b * y[i] - c;
      reach[i] = out > reach[i] ? out : reach[i];
    }
  }
}

// Marks the points of a block that reach out of both regions by more than a limit.
BOXGRASP_SIMD void markOpen(const float* x, const float* y, const HalfPlane* a, std::size_t count_a,
                            const HalfPlane* b, std::size_t count_b, float limit, std::uint8_t* mark) {
  float out_a[kPointBlock], out_b[kPointBlock];
  pointsOut(x, y, a, count_a, out_a);
  pointsOut(x, y, b, count_b, out_b);
  for (std::size_t i = 0; i < kPointBlock; ++i) mark[i] = (out_a[i] > limit) & (out_b[i] > limit);
}

}  // namespace mark_passes

PointMarks openPoints(const float* x, const float* y, const Region& a, const Region& b, float margin) {
  PointMarks marks;
  mark_passes::markOpen(x, y, a.data(), a.size(), b.data(), b.size(), -margin, marks.data());
  return marks;
}

}  // namespace boxgrasp
