#include "boxgrasp/cloud/neighbours.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

#include "boxgrasp/base/ordered_bits.h"
#include "boxgrasp/base/parallel.h"
#include "boxgrasp/base/simd.h"
#include "boxgrasp/geometry/voxels.h"

namespace boxgrasp {
namespace neighbour_passes {

constexpr std::size_t kLanes = 8;

// The radius squared that holds `wanted` of n points, and how many it holds: more where those farthest are
// equally far away. `upto`: how many the limit holds. On a surface their number grows as the square of the
// radius does.
BOXGRASP_SIMD_PART std::pair<float, int> radiusOf(int wanted, const float* squared, std::size_t n,
                                                  float limit, int upto) {
  float below = 0.0f, within = limit;
  for (int inside = 0; upto > wanted;) {
    const float share = (static_cast<float>(wanted - inside) + 0.5f) / static_cast<float>(upto - inside + 1);
    const float middle = below + (within - below) * std::clamp(share, 0.125f, 0.875f);
    if (!(below < middle && middle < within)) break;
    int count = 0;
    for (std::size_t i = 0; i < n; ++i) count += squared[i] <= middle;
    (count >= wanted ? upto : inside) = count;
    (count >= wanted ? within : below) = middle;
  }
  return {within, upto};
}

// The least of n values, or the limit.
BOXGRASP_SIMD_PART float leastOf(const float* values, std::size_t n, float limit) {
  std::int32_t least = orderedBits(limit);
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t value = orderedBits(values[i]);
    least = value < least ? value : least;
  }
  return fromOrderedBits(least);
}

// The sum of the roots of those of n values that do not exceed the limit. Changes the values.
BOXGRASP_SIMD_PART float sumOfRoots(float* values, std::size_t n, float limit) {
  float sums[kLanes] = {};
  for (std::size_t i = 0; i < n; ++i) values[i] = std::sqrt(values[i] <= limit ? values[i] : 0.0f);
  for (std::size_t i = 0; i < n; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) sums[lane] += values[i + lane];
  }
  return std::accumulate(sums, sums + kLanes, 0.0f);
}

// The distances from p, which is one of n points, to the nearest of the others, and to the k nearest of them
// in sum. False where there are no k others within the limit. `squared` has room for n. Pre: n is a multiple
// of kLanes.
BOXGRASP_SIMD bool measure(const float* x, const float* y, const float* z, std::size_t n, const float* p,
                           int k, float limit, float* squared, float& nearest, float& sum) {
  int upto = 0, coincident = -1;
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = x[i] - p[0], dy = y[i] - p[1], dz = z[i] - p[2];
    const float d = dx * dx + dy * dy + dz * dz;
    coincident += d == 0.0f;
    squared[i] = d == 0.0f ? std::numeric_limits<float>::infinity() : d;
    upto += squared[i] <= limit;
  }
  const int wanted = std::max(0, k - coincident);
  if (upto < wanted) return false;
  const auto [within, held] = radiusOf(wanted, squared, n, limit, upto);
  nearest = coincident > 0 ? 0.0f : std::sqrt(leastOf(squared, n, limit));
  sum = sumOfRoots(squared, n, within) - static_cast<float>(held - wanted) * std::sqrt(within);
  return true;
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
        limit_(static_cast<float>(radius_m * radius_m)) {
    cloud_.resize(cloud_.size() + kCopied);
  }

  // Fills in the distances of the points that have none yet and enough neighbours; returns whether all have
  // them then.
  bool fill(NeighbourDistances& distances, int threads, const StopToken& stop) const;

 private:
  static constexpr std::size_t kStretch = 256;  // cells that one thread takes at a time
  static constexpr std::size_t kCopied = 16;    // points at a time: more than most rows of cells have

  // The points around one cell, and room for distances.
  class Block {
   public:
    void clear() { size_ = 0; }
    // Pre: the cloud has kCopied more points behind the last, whatever they are.
    void append(const PointCloud& cloud, std::size_t first, std::size_t last);
    // With points far away, to whole lanes.
    void fillUp();

    std::size_t size() const { return size_; }
    const float* x() const { return x_.data(); }
    const float* y() const { return y_.data(); }
    const float* z() const { return z_.data(); }
    float* squared() { return squared_.data(); }

   private:
    void makeRoom(std::size_t size);

    std::vector<float> x_, y_, z_, squared_;
    std::size_t size_ = 0;
  };

  bool fillCells(std::size_t first, std::size_t end, NeighbourDistances& distances) const;
  void enter(std::size_t cell, NeighbourSweep& sweep, Block& block) const;
  void fillPoint(std::size_t at, Block& block, double& mean, double& nearest) const;

  Voxels cells_;
  PointCloud cloud_;  // in the order of the cells, so that a row of cells is one stretch; and room behind
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

void BlockSearch::Block::makeRoom(std::size_t size) {
  if (size <= x_.size()) return;
  for (std::vector<float>* values : {&x_, &y_, &z_, &squared_}) values->resize(2 * size);
}

// In whole pieces: what is copied too much is written over, or filled up.
void BlockSearch::Block::append(const PointCloud& cloud, std::size_t first, std::size_t last) {
  makeRoom(size_ + (last - first) + kCopied);
  for (std::size_t from = first; from < last; from += kCopied) {
    const std::size_t to = size_ + from - first;
    std::memcpy(&x_[to], &cloud.x[from], kCopied * sizeof(float));
    std::memcpy(&y_[to], &cloud.y[from], kCopied * sizeof(float));
    std::memcpy(&z_[to], &cloud.z[from], kCopied * sizeof(float));
  }
  size_ += last - first;
}

void BlockSearch::Block::fillUp() {
  constexpr std::size_t kLanes = neighbour_passes::kLanes;
  makeRoom(size_ + kLanes);
  for (; size_ % kLanes != 0; ++size_)
    x_[size_] = y_[size_] = z_[size_] = std::numeric_limits<float>::infinity();
}

void BlockSearch::enter(std::size_t cell, NeighbourSweep& sweep, Block& block) const {
  block.clear();
  sweep.around(cell, [&](std::size_t first, std::size_t last) {
    block.append(cloud_, cells_.begin[first], cells_.begin[last]);
  });
  block.fillUp();
}

void BlockSearch::fillPoint(std::size_t at, Block& block, double& mean, double& nearest) const {
  const float p[] = {cloud_.x[at], cloud_.y[at], cloud_.z[at]};
  float to_nearest = 0.0f, sum = 0.0f;
  if (!neighbour_passes::measure(block.x(), block.y(), block.z(), block.size(), p, static_cast<int>(k_),
                                 limit_, block.squared(), to_nearest, sum))
    return;
  nearest = to_nearest;
  mean = static_cast<double>(sum) / static_cast<double>(k_);
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
