// A uniform grid over a cloud for neighbour queries in constant expected time.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// Holds a reference to the cloud, which must outlive it. Immutable after construction, so safe to share
// between threads. Memory is bounded by the points, not by the volume: an outlier far away costs one cell.
class PointGrid {
 public:
  // Pre: cell_m > 0.
  PointGrid(const PointCloud& cloud, double cell_m);

  // Indices of the points within `radius_m` of p, ascending.
  std::vector<std::uint32_t> within(const Vector3d& p, double radius_m) const;

  // The nearest point within `radius_m`, the smaller index of equals; nullopt when there is none.
  std::optional<std::uint32_t> nearest(const Vector3d& p, double radius_m) const;

  // Calls visit(index) for every point in the axis-aligned box, and maybe for others near it; visit returns
  // true to stop. Returns whether it was stopped.
  template <typename Visit>
  bool visitBox(const Eigen::AlignedBox3d& box, Visit&& visit) const;

  const PointCloud& cloud() const { return *cloud_; }

 private:
  struct Cell {
    std::uint32_t begin = 0, end = 0;  // into order_
  };
  using Index = Eigen::Vector3i;

  // Cells lie around a typical point. Beyond 2^20 cells from it they are no longer told apart: the outermost
  // reach to infinity.
  Index cellOf(const Vector3d& p) const;
  static std::uint64_t keyOf(const Index& cell);
  static Index indexOf(std::uint64_t key);
  std::size_t slotOf(std::uint64_t key) const;  // where the key is, or the empty slot where it belongs
  std::uint32_t insert(std::uint64_t key);      // the number of the cell with this key
  const Cell* find(const Index& cell) const;
  template <typename Visit>
  bool visitCell(const Cell& cell, Visit& visit) const;

  const PointCloud* cloud_;
  double cell_m_;
  Vector3d origin_;
  std::vector<std::uint64_t> keys_;   // of the occupied cells, in order of their first point
  std::vector<Cell> cells_;           // parallel to keys_
  std::vector<std::uint32_t> slots_;  // open-addressing hash from key to cell number plus one; 0 = empty
  std::vector<std::uint32_t> order_;  // point indices, cell by cell, ascending in each
};

template <typename Visit>
bool PointGrid::visitCell(const Cell& cell, Visit& visit) const {
  for (std::uint32_t n = cell.begin; n < cell.end; ++n) {
    if (visit(order_[n])) return true;
  }
  return false;
}

template <typename Visit>
bool PointGrid::visitBox(const Eigen::AlignedBox3d& box, Visit&& visit) const {
  if (box.isEmpty()) return false;
  const Index from = cellOf(box.min()), to = cellOf(box.max());
  // A box of more cells than are occupied is answered from the occupied ones.
  if ((to - from + Index::Ones()).cast<double>().prod() > static_cast<double>(cells_.size())) {
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const Index cell = indexOf(keys_[i]);
      const bool inside = (cell.array() >= from.array()).all() && (cell.array() <= to.array()).all();
      if (inside && visitCell(cells_[i], visit)) return true;
    }
    return false;
  }
  for (int k = from.z(); k <= to.z(); ++k) {
    for (int j = from.y(); j <= to.y(); ++j) {
      for (int i = from.x(); i <= to.x(); ++i) {
        const Cell* cell = find({i, j, k});
        if (cell && visitCell(*cell, visit)) return true;
      }
    }
  }
  return false;
}

}  // namespace boxgrasp
