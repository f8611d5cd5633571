// Points in metres, as three arrays: the passes over all points that the planner makes are vectorised.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

// x, y and z always have the same length. The frame is the owner's: `cloud_C` holds points in frame C.
struct PointCloud {
  std::vector<float> x, y, z;

  std::size_t size() const { return x.size(); }
  bool empty() const { return x.empty(); }
  Vector3d point(std::size_t i) const { return {x[i], y[i], z[i]}; }
  void reserve(std::size_t n);
  void resize(std::size_t n);
  void push(const Vector3d& p);
  bool operator==(const PointCloud&) const = default;
};

// The points at `indices`, in that order.
PointCloud select(const PointCloud& cloud, const std::vector<std::uint32_t>& indices);

// All points of the first cloud, then all of the second.
PointCloud joined(PointCloud first, const PointCloud& second);

// The mean of all points. Pre: not empty.
Vector3d meanOf(const PointCloud& cloud);

// Every point p_A of the cloud as p_B = X_BA * p_A, computed in double and rounded once.
PointCloud transformed(const PointCloud& cloud_A, const Pose& X_BA);

// The axis-aligned bounds; an empty box (isEmpty()) for an empty cloud.
Eigen::AlignedBox3d bounds(const PointCloud& cloud);

// The smallest and the largest dot product of the points from `begin` to before `end` with a direction.
struct Interval {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
};
Interval rangeAlong(const PointCloud& cloud, std::size_t begin, std::size_t end, const Vector3d& direction);

// The smallest and the largest dot product of any point with each of three directions (columns of `axes`).
struct AxisRanges {
  Vector3d min;
  Vector3d max;
};
AxisRanges rangesAlong(const PointCloud& cloud, const Matrix3d& axes);

}  // namespace boxgrasp
