// A uniform grid over a cloud for neighbour queries in constant expected time.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// Holds a reference to the cloud, which must outlive it. Immutable after construction, so safe to share between threads.
// Memory is bounded by the points, not by the volume: an outlier far away costs one cell.
class PointGrid {
 public:
  // Pre: cell_m > 0.
  PointGrid(const PointCloud& cloud, double cell_m);

  // Indices of the points within `radius_m` of p, ascending.
  std::vector<std::uint32_t> within(const Vector3d& p, double radius_m) const;

  // The nearest point within `radius_m`, the smaller index of equals; nullopt when there is none.
  std::optional<std::uint32_t> nearest(const Vector3d& p, double radius_m) const;

  // Calls visit(index) for every point in the axis-aligned box, and maybe for others near it; visit returns true to stop.
  // Returns whether it was stopped.
  template <typename Visit>
  bool visitBox(const Eigen::AlignedBox3d& box, Visit&& visit) const;

  const PointCloud& cloud() const { return *cloud_; }

 private:
  struct Cell {
    std::uint32_t begin = 0, end = 0;  // into order_
  };
  Eigen::Vector3i cellOf(const Vector3d& p) const;
  const Cell* find(const Eigen::Vector3i& cell) const;

  const PointCloud* cloud_;
  double cell_m_;
  Vector3d origin_;
  Eigen::Vector3i size_;                 // cells along each axis
  std::vector<std::uint64_t> keys_;      // sorted keys of the occupied cells
  std::vector<Cell> cells_;              // parallel to keys_
  std::vector<std::uint32_t> slots_;     // open-addressing hash from key to index in keys_, plus one; 0 = empty
  std::vector<std::uint32_t> order_;     // point indices, cell by cell
};

template <typename Visit>
bool PointGrid::visitBox(const Eigen::AlignedBox3d& box, Visit&& visit) const {
  const Eigen::Vector3i low = cellOf(box.min()), high = cellOf(box.max());
  const Eigen::Vector3i from = low.cwiseMax(0), to = high.cwiseMin(size_ - Eigen::Vector3i::Ones());
  for (int k = from.z(); k <= to.z(); ++k) {
    for (int j = from.y(); j <= to.y(); ++j) {
      for (int i = from.x(); i <= to.x(); ++i) {
        const Cell* cell = find({i, j, k});
        if (!cell) continue;
        for (std::uint32_t n = cell->begin; n < cell->end; ++n) {
          if (visit(order_[n])) return true;
        }
      }
    }
  }
  return false;
}

}  // namespace boxgrasp
