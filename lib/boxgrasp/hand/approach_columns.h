// The points of a scene in columns along a direction of approach.
#pragma once

#include <cstdint>
#include <vector>

#include "boxgrasp/geometry/point_grid.h"

namespace boxgrasp {

// What a hand that comes along +z of frame A could meet: the points, in A, in square columns parallel to z,
// each column sorted by z. A hand sweeps whole columns on its way in, so a look at a column's first point
// mostly settles it. Immutable after construction, so safe to share between threads. Memory: the points, and
// one number for each column of the region.
class ApproachColumns {
 public:
  // Takes the points inside `region_A`. Pre: region_A is not empty, and finite.
  ApproachColumns(const PointGrid& scene_C, const Pose& X_CA, const Eigen::AlignedBox3d& region_A);

  // Calls visit(p_A) for the points of the columns that meet the rectangle, with z in [min.z, max.z] of
  // `box`, column by column; visit returns true to stop. Returns whether it was stopped.
  template <typename Visit>
  bool visit(const Eigen::AlignedBox3d& box_A, Visit&& visit) const;

  const Pose& X_CA() const { return X_CA_; }
  std::size_t size() const { return points_A_.size(); }

 private:
  int clampedColumn(double offset_m, int count) const;
  std::size_t columnOf(const Eigen::Vector3f& p_A) const;
  void sortIntoColumns(const std::vector<Eigen::Vector3f>& points_A);

  Pose X_CA_;
  Vector2d origin_;  // lower corner of the columns
  int nx_ = 0, ny_ = 0;
  std::vector<std::uint32_t> begin_;  // of each column in points_A_, row by row; one more at the end
  std::vector<Eigen::Vector3f> points_A_;
};

template <typename Visit>
bool ApproachColumns::visit(const Eigen::AlignedBox3d& box_A, Visit&& visit) const {
  const Vector2d from = box_A.min().head<2>() - origin_, to = box_A.max().head<2>() - origin_;
  const int i0 = clampedColumn(from.x(), nx_), i1 = clampedColumn(to.x(), nx_);
  const int j0 = clampedColumn(from.y(), ny_), j1 = clampedColumn(to.y(), ny_);
  const float z_min = static_cast<float>(box_A.min().z()), z_max = static_cast<float>(box_A.max().z());
  for (int j = j0; j <= j1; ++j) {
    const std::uint32_t* column = &begin_[static_cast<std::size_t>(j) * nx_];
    for (int i = i0; i <= i1; ++i) {
      for (std::uint32_t n = column[i]; n < column[i + 1] && points_A_[n].z() <= z_max; ++n) {
        if (points_A_[n].z() >= z_min && visit(points_A_[n])) return true;
      }
    }
  }
  return false;
}

}  // namespace boxgrasp
