#include "boxgrasp/cloud/neighbours.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "boxgrasp/base/parallel.h"
#include "boxgrasp/base/simd.h"
#include "boxgrasp/geometry/voxels.h"

namespace boxgrasp {
namespace neighbour_passes {

// Appends the squared distances from p to n points that do not exceed a limit; returns how many there are
// then. `squared` has room for n more.
BOXGRASP_SIMD std::size_t appendNear(const float* x, const float* y, const float* z, std::size_t n,
                                     const float* p, float limit, float* squared, std::size_t count) {
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = x[i] - p[0], dy = y[i] - p[1], dz = z[i] - p[2];
    const float d = dx * dx + dy * dy + dz * dz;
    squared[count] = d;
    count += d <= limit;  // without a branch: one in three is near
  }
  return count;
}

}  // namespace neighbour_passes

namespace {

// Searches the 27 cells around each point; a point has all its neighbours within the radius there.
class BlockSearch {
 public:
  BlockSearch(const PointCloud& cloud, std::size_t k, double radius_m)
      : cells_(
            sortIntoVoxels(cloud, radius_m * 1.0001)),  // so that rounding puts no neighbour two cells away
        cloud_(select(cloud, cells_.order)),
        k_(k),
        limit_(static_cast<float>(radius_m * radius_m)) {}

  // Fills in the distances of the points that have none yet and enough neighbours; returns whether all have
  // them then.
  bool fill(NeighbourDistances& distances, int threads, const StopToken& stop) const;

 private:
  static constexpr std::size_t kStretch = 256;  // cells that one thread takes at a time

  // The points around one cell, and room for their distances.
  struct Block {
    std::vector<std::pair<std::size_t, std::size_t>> rows;
    std::vector<float> squared;
  };

  bool fillCells(std::size_t first, std::size_t end, NeighbourDistances& distances) const;
  void enter(std::size_t cell, NeighbourSweep& sweep, Block& block) const;
  void fillPoint(std::size_t at, Block& block, double& mean, double& nearest) const;
  std::size_t collectNear(std::size_t at, Block& block) const;

  Voxels cells_;
  PointCloud cloud_;  // in the order of the cells, so that a row of cells is one stretch of points
  std::size_t k_;
  float limit_;
};

bool BlockSearch::fill(NeighbourDistances& distances, int threads, const StopToken& stop) const {
  std::vector<char> filled((cells_.size() + kStretch - 1) / kStretch);
  parallelFor(filled.size(), threads, [&](std::size_t i) {
    stop.check();
    filled[i] = fillCells(i * kStretch, std::min(cells_.size(), (i + 1) * kStretch), distances);
  });
  return std::ranges::all_of(filled, [](char all) { return all != 0; });
}

bool BlockSearch::fillCells(std::size_t first, std::size_t end, NeighbourDistances& distances) const {
  const auto missing = [&](std::uint32_t i) { return distances.mean[i] < 0.0; };
  NeighbourSweep sweep(cells_, first);
  Block block;
  bool all = true;
  for (std::size_t cell = first; cell < end; ++cell) {
    if (std::ranges::none_of(cells_.points(cell), missing)) continue;
    enter(cell, sweep, block);
    for (std::size_t at = cells_.begin[cell]; at < cells_.begin[cell + 1]; ++at) {
      const std::uint32_t i = cells_.order[at];
      if (missing(i)) fillPoint(at, block, distances.mean[i], distances.nearest[i]);
      all = all && !missing(i);
    }
  }
  return all;
}

void BlockSearch::enter(std::size_t cell, NeighbourSweep& sweep, Block& block) const {
  std::size_t size = 0;
  block.rows.clear();
  sweep.around(cell, [&](std::size_t first, std::size_t last) {
    block.rows.emplace_back(cells_.begin[first], cells_.begin[last]);
    size += cells_.begin[last] - cells_.begin[first];
  });
  if (block.squared.size() <= size) block.squared.resize(size + 1);
}

std::size_t BlockSearch::collectNear(std::size_t at, Block& block) const {
  const float p[] = {cloud_.x[at], cloud_.y[at], cloud_.z[at]};
  std::size_t count = 0;
  for (const auto& [begin, end] : block.rows) {
    count = neighbour_passes::appendNear(&cloud_.x[begin], &cloud_.y[begin], &cloud_.z[begin], end - begin, p,
                                         limit_, block.squared.data(), count);
  }
  return count;
}

void BlockSearch::fillPoint(std::size_t at, Block& block, double& mean, double& nearest) const {
  const std::size_t count = collectNear(at, block);
  if (count <= k_) return;  // the point itself is among them, at distance 0
  const auto begin = block.squared.begin(), last = begin + static_cast<std::ptrdiff_t>(k_);
  std::nth_element(begin, last, begin + static_cast<std::ptrdiff_t>(count));
  std::iter_swap(begin, std::min_element(begin, last));  // the point itself goes first
  nearest = std::sqrt(*std::min_element(begin + 1, last + 1));
  double sum = 0.0;
  for (auto d = begin; d <= last; ++d) sum += std::sqrt(*d);
  mean = sum / static_cast<double>(k_);
}

}  // namespace

NeighbourDistances neighbourDistances(const PointCloud& cloud, int k, double radius_m, int threads,
                                      const StopToken& stop) {
  assert(k >= 1 && static_cast<std::size_t>(k) < cloud.size() && radius_m > 0.0);
  NeighbourDistances distances{std::vector<double>(cloud.size(), -1.0),
                               std::vector<double>(cloud.size(), -1.0)};
  while (!BlockSearch(cloud, static_cast<std::size_t>(k), radius_m).fill(distances, threads, stop))
    radius_m *= 2.0;
  return distances;
}

}  // namespace boxgrasp
