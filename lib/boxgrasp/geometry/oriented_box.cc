#include "boxgrasp/geometry/oriented_box.h"

#include <cassert>

#include "boxgrasp/base/tolerances.h"

namespace boxgrasp {

bool OrientedBox::contains(const Vector3d& p_C, double margin_m) const {
  const Vector3d p_B = X_CB.inverse() * p_C;
  return (p_B.cwiseAbs().array() <= 0.5 * extents.array() + margin_m).all();
}

std::array<Vector3d, 8> OrientedBox::corners() const {
  std::array<Vector3d, 8> corners;
  for (int i = 0; i < 8; ++i) {
    const Vector3d signs(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    corners[i] = X_CB * (0.5 * signs.cwiseProduct(extents));
  }
  return corners;
}

OrientedBox boxAround(const PointCloud& cloud_C, const Matrix3d& axes_C) {
  assert(!cloud_C.empty());
  return boxAround(rangesAlong(cloud_C, axes_C), axes_C);
}

OrientedBox boxAround(const AxisRanges& ranges, const Matrix3d& axes_C) {
  OrientedBox box;
  box.X_CB = makePose(axes_C, axes_C * (0.5 * (ranges.min + ranges.max)));
  box.extents = (ranges.max - ranges.min).cwiseMax(tolerance::kFlatExtent);
  return box;
}

}  // namespace boxgrasp
