// The points of a scene in columns along a direction of approach.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "boxgrasp/geometry/point_grid.h"

namespace boxgrasp {

// What a hand that comes along +z of frame A could meet: the points, in A, in square columns parallel to z,
// each column ordered by z. A hand sweeps whole columns on its way in, so a look at a column's first point
// mostly settles it. Immutable after construction, so safe to share between threads. Memory: the points, and
// two numbers for each column.
class ApproachColumns {
 public:
  // Takes the points inside `region_A`. O(points + columns). Pre: region_A is not empty, and of at most some
  // metres.
  ApproachColumns(const PointGrid& scene_C, const Pose& X_CA, const Eigen::AlignedBox3d& region_A);

  // Calls visit(p_A) for every point in the box, and maybe for others in the same columns and heights; visit
  // returns true to stop. Returns whether it was stopped.
  template <typename Visit>
  bool visit(const Eigen::AlignedBox3d& box_A, Visit&& visit) const;

  const Pose& X_CA() const { return X_CA_; }
  std::size_t size() const { return points_A_.size(); }

 private:
  static constexpr double kColumn_m = 0.004;  // half a link's radius: few points beside a link are looked at
  static constexpr double kLayer_m = 0.001;   // points of a column are in order of z to within this

  static int cellOf(double offset_m, double cell_m, int count) {
    return static_cast<int>(std::clamp(offset_m / cell_m, 0.0, count - 1.0));
  }
  void sortIntoColumns(const std::vector<Eigen::Vector3f>& points_A, const Eigen::AlignedBox3d& bounds_A);

  Pose X_CA_;
  Vector2d origin_;  // lower corner of the columns
  int nx_ = 0, ny_ = 0;
  std::vector<float> first_;          // least z in each column, row by row; infinity in an empty one
  std::vector<std::uint32_t> begin_;  // of each column in points_A_; one more at the end
  std::vector<Eigen::Vector3f> points_A_;
};

template <typename Visit>
bool ApproachColumns::visit(const Eigen::AlignedBox3d& box_A, Visit&& visit) const {
  const Vector2d from = box_A.min().head<2>() - origin_, to = box_A.max().head<2>() - origin_;
  const int i0 = cellOf(from.x(), kColumn_m, nx_), i1 = cellOf(to.x(), kColumn_m, nx_);
  const int j0 = cellOf(from.y(), kColumn_m, ny_), j1 = cellOf(to.y(), kColumn_m, ny_);
  const auto z_min = static_cast<float>(box_A.min().z()), z_max = static_cast<float>(box_A.max().z());
  const auto last_z = static_cast<float>(box_A.max().z() + kLayer_m);
  for (int j = j0; j <= j1; ++j) {
    const std::size_t row = static_cast<std::size_t>(j) * nx_;
    for (std::size_t column = row + i0; column <= row + i1; ++column) {
      if (first_[column] > z_max) continue;
      for (std::uint32_t n = begin_[column]; n < begin_[column + 1] && points_A_[n].z() <= last_z; ++n) {
        const float z = points_A_[n].z();
        if (z >= z_min && z <= z_max && visit(points_A_[n])) return true;
      }
    }
  }
  return false;
}

}  // namespace boxgrasp
