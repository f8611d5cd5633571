// The outermost points of a cloud. Part of minVolumeBox.
#pragma once

#include <array>

#include "boxgrasp/geometry/block_ranges.h"
#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// Looks only where runs of points can reach out far enough, so it is fast where neighbours in the cloud's
// order are neighbours in space; in any other order it looks at all points. The cloud is the owner's.
class SupportPoints {
 public:
  // Pre: the cloud is finite and not empty.
  explicit SupportPoints(const PointCloud& cloud);

  // Appends to `found` the points of the cloud that are lowest and highest along each of the directions,
  // measured from `origin` in single precision. Of equal points the one with the smallest coordinates is
  // taken, so the order of the cloud does not matter.
  void append(const Vector3d& origin, const std::vector<Vector3d>& directions, PointCloud& found) const;

  // What bounds() gives for the cloud.
  Eigen::AlignedBox3d bounds() const;

  // What rangesAlong() gives for the cloud.
  AxisRanges ranges(const Matrix3d& axes) const;

 private:
  const PointCloud& cloud_;
  std::array<BlockRanges, 3> coordinates_;
  double reach_ = 0.0;  // the largest coordinate
};

}  // namespace boxgrasp
