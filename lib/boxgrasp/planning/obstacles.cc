#include "boxgrasp/planning/obstacles.h"

namespace boxgrasp {
namespace {

// A frame on the plane: origin at the plane's point nearest to `p_C`, z along the plane's normal.
Pose planeFrame(const Plane& plane, const Vector3d& p_C) {
  const Vector3d x = plane.normal_C.unitOrthogonal();
  Matrix3d axes;
  axes << x, plane.normal_C.cross(x), plane.normal_C;
  return makePose(axes, p_C - (plane.normal_C.dot(p_C) - plane.offset_m) * plane.normal_C);
}

}  // namespace

PointCloud tablePatch(const Plane& table, const PointCloud& object_C, double reach_m, double spacing_m) {
  const Pose X_CT = planeFrame(table, object_C.point(0));
  const Eigen::AlignedBox3d shadow = bounds(transformed(object_C, X_CT.inverse()));
  PointCloud patch;
  for (double x = shadow.min().x() - reach_m; x <= shadow.max().x() + reach_m; x += spacing_m) {
    for (double y = shadow.min().y() - reach_m; y <= shadow.max().y() + reach_m; y += spacing_m) {
      patch.push(X_CT * Vector3d(x, y, 0.0));
    }
  }
  return patch;
}

}  // namespace boxgrasp
