// Oriented bounding boxes.
#pragma once

#include <array>

#include "boxgrasp/geometry/point_cloud.h"
#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

// A box centred on its frame B, whose axes are the box's edges, right-handed. Extents are full edge lengths
// in metres.
struct OrientedBox {
  Pose X_CB = Pose::Identity();
  Vector3d extents = Vector3d::Constant(-1.0);  // an impossible value until set

  double volume() const { return extents.prod(); }
  bool contains(const Vector3d& p_C, double margin_m = 0.0) const;
  std::array<Vector3d, 8> corners()
      const;  // in C; bit k of a corner's number is set on the positive side of axis k
};

// The box with the given axes (columns, right-handed) around all points; flat extents are raised to
// tolerance::kFlatExtent. Pre: the cloud is not empty.
OrientedBox boxAround(const PointCloud& cloud_C, const Matrix3d& axes_C);

// The same from the ranges of the points along the axes.
OrientedBox boxAround(const AxisRanges& ranges, const Matrix3d& axes_C);

}  // namespace boxgrasp
