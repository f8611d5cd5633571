#include "boxgrasp/decomposition/face_projection.h"

#include <algorithm>
#include <cmath>

namespace boxgrasp {

FaceProjection projectNode(const PointCloud& cloud_C, const BoxNode& node, int axis) {
  FaceProjection face;
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  face.axis = axis;
  face.area = node.box.extents[i] * node.box.extents[j];
  face.origin_C = node.box.X_CB.translation();
  face.x_C = node.box.X_CB.linear().col(i);
  face.y_C = node.box.X_CB.linear().col(j);
  face.x.reserve(node.points.size());
  face.y.reserve(node.points.size());
  for (const std::uint32_t index : node.points) {
    const Vector3d p = cloud_C.point(index) - face.origin_C;
    face.x.push_back(face.x_C.dot(p));
    face.y.push_back(face.y_C.dot(p));
  }
  return face;
}

Cut cutAlong(const FaceProjection& face, const Line& line) {
  Cut cut;
  cut.axis = face.axis;
  cut.normal_C = line.normal.x() * face.x_C + line.normal.y() * face.y_C;
  cut.offset_m = line.offset + cut.normal_C.dot(face.origin_C);
  return cut;
}

Split splitBy(const FaceProjection& face, const Line& line, double theta,
              const std::vector<std::uint32_t>& points) {
  Split split{theta, cutAlong(face, line), {}, {}};
  for (std::size_t i = 0; i < face.size(); ++i) {
    (line.normal.dot(face.point(i)) <= line.offset ? split.first : split.second).push_back(points[i]);
  }
  return split;
}

std::size_t leastPoints(std::size_t points, double min_point_fraction) {
  return std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil(min_point_fraction * static_cast<double>(points))));
}

}  // namespace boxgrasp
