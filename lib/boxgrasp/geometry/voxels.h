// Sorting points into voxels, in an order that depends on where the points are and not on how they were
// given.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// The occupied voxels of a cloud, ordered by z, then y, then x.
struct Voxels {
  std::vector<std::uint32_t> order;         // point indices, voxel by voxel, ascending in each
  std::vector<std::uint32_t> begin;         // where each voxel begins in `order`, and one more for the end
  std::vector<std::int64_t> keys;           // of each voxel, ascending: x + y * stride_y + z * stride_z
  std::int64_t stride_y = 0, stride_z = 0;  // wide enough that neighbours of different rows never share a key

  std::size_t size() const { return begin.size() - 1; }
  std::span<const std::uint32_t> points(std::size_t voxel) const {
    return {order.data() + begin[voxel], begin[voxel + 1] - begin[voxel]};
  }
};

// Voxels of this edge, one of them centred on the frame's origin: a flat cloud through it lies inside one
// layer. The edge is raised to 2^-20 of the cloud's extent. O(n). Pre: finite, not empty, edge_m > 0.
Voxels sortIntoVoxels(const PointCloud& cloud, double edge_m);

// Whether the occupied ones of these voxels hang together, each touching others by a face, an edge or a corner. A quick
// look, without sorting: false, too, where the voxels around the cloud are many more than its points. Pre: as above.
bool voxelsHangTogether(const PointCloud& cloud, double edge_m);

// The mean of some points to 2^-26 m, the same in whatever order they come. Pre: not empty, within 1 km.
Vector3d meanOf(const PointCloud& cloud, std::span<const std::uint32_t> points);

// The mean of each voxel's points.
PointCloud meansOf(const PointCloud& cloud, const Voxels& voxels, int threads = 1);

// Walks over the voxels in ascending order and finds the occupied ones among the 27 around each: nine rows
// whose places only ever move forward.
class NeighbourSweep {
 public:
  // Begins at the voxel `first`.
  explicit NeighbourSweep(const Voxels& voxels, std::size_t first = 0);

  // Calls visit(first, last) for each row of occupied voxels [first, last) around this one; itself is among
  // them. Pre: voxels are given in ascending order, none below the one to begin at.
  template <typename Visit>
  void around(std::size_t voxel, Visit&& visit);

 private:
  // The key in the middle of a row around the voxel.
  std::int64_t middleOf(int row, std::size_t voxel) const {
    return voxels_.keys[voxel] + (row / 3 - 1) * voxels_.stride_z + (row % 3 - 1) * voxels_.stride_y;
  }

  const Voxels& voxels_;
  std::array<std::size_t, 9> row_{};
};

template <typename Visit>
void NeighbourSweep::around(std::size_t voxel, Visit&& visit) {
  const auto& keys = voxels_.keys;
  for (int row = 0; row < 9; ++row) {
    const std::int64_t middle = middleOf(row, voxel);
    std::size_t& first = row_[row];
    while (first < keys.size() && keys[first] < middle - 1) ++first;
    std::size_t last = first;
    while (last < keys.size() && keys[last] <= middle + 1) ++last;
    if (first < last) visit(first, last);
  }
}

}  // namespace boxgrasp
