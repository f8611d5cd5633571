#include "boxgrasp/cloud/clusters.h"

#include <algorithm>
#include <numeric>

#include "boxgrasp/geometry/voxels.h"

namespace boxgrasp {
namespace {

// Disjoint sets of 0 .. n-1; the smallest member stands for its set.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }

  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

std::vector<std::vector<std::uint32_t>> groupsOf(DisjointSets& sets, std::size_t n) {
  std::vector<std::vector<std::uint32_t>> groups(n);
  for (std::uint32_t i = 0; i < n; ++i) groups[sets.find(i)].push_back(i);
  std::erase_if(groups, [](const auto& group) { return group.empty(); });
  std::ranges::stable_sort(groups, [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return groups;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> euclideanClusters(const PointCloud& cloud, double distance_m,
                                                          const StopToken& stop) {
  const Voxels cells =
      sortIntoVoxels(cloud, distance_m * 1.0001);  // so that rounding puts no neighbour two cells away
  const double limit = distance_m * distance_m;
  DisjointSets sets(cloud.size());
  const auto join = [&](std::uint32_t i, std::uint32_t j) {
    if (sets.find(i) == sets.find(j)) return;
    if ((cloud.point(i) - cloud.point(j)).squaredNorm() <= limit) sets.unite(i, j);
  };
  NeighbourSweep sweep(cells);
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    if (cell % 64 == 0) stop.check();
    sweep.around(cell, [&](std::size_t first, std::size_t last) {
      for (std::size_t other = first; other < std::min(last, cell + 1); ++other) {
        for (const std::uint32_t i : cells.points(cell)) {
          for (const std::uint32_t j : cells.points(other)) join(i, j);
        }
      }
    });
  }
  return groupsOf(sets, cloud.size());
}

}  // namespace boxgrasp
