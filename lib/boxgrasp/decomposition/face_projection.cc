#include "boxgrasp/decomposition/face_projection.h"

#include <algorithm>
#include <cmath>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {

namespace projection_passes {

BOXGRASP_SIMD std::uint32_t countFirst(const float* x, const float* y, std::size_t n, float normal_x,
                                       float normal_y, float offset) {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < n; ++i) count += normal_x * x[i] + normal_y * y[i] <= offset ? 1u : 0u;
  return count;
}

}  // namespace projection_passes

FaceProjection projectionAlong(int axis, const OrientedBox& box, const PointCloud& cloud_B) {
  const std::array<std::span<const float>, 3> coordinates{cloud_B.x, cloud_B.y, cloud_B.z};
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  return {axis, box.extents[i] * box.extents[j], coordinates[i], coordinates[j]};
}

Cut cutAlong(const Line& line, int axis, const OrientedBox& box) {
  const Vector2d normal(line.normal_x, line.normal_y);  // a unit vector in single precision only
  Cut cut;
  cut.axis = axis;
  cut.normal_C = (normal.x() * box.X_CB.linear().col((axis + 1) % 3) +
                  normal.y() * box.X_CB.linear().col((axis + 2) % 3)) /
                 normal.norm();
  cut.offset_m = line.offset / normal.norm() + cut.normal_C.dot(box.X_CB.translation());
  return cut;
}

std::size_t countFirst(const FaceProjection& face, const Line& line) {
  return projection_passes::countFirst(face.x.data(), face.y.data(), face.size(), line.normal_x,
                                       line.normal_y, line.offset);
}

std::size_t leastPoints(std::size_t points, double min_point_fraction) {
  return std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil(min_point_fraction * static_cast<double>(points))));
}

}  // namespace boxgrasp
