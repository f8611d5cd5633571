#include "boxgrasp/decomposition/z_order.h"

#include <algorithm>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {

namespace z_order_passes {

constexpr std::uint32_t kCells = 32;  // along each edge

struct Grid {
  float low[3];
  float scale;
};

// Leaves two empty bits between the five bits of a number.
BOXGRASP_SIMD_PART std::uint32_t spread(std::uint32_t number) {
  const std::uint32_t halved = (number | number << 8) & 0x100fu;
  const std::uint32_t quartered = (halved | halved << 4) & 0x10c3u;
  return (quartered | quartered << 2) & 0x1249u;
}

BOXGRASP_SIMD_PART std::uint32_t cellAlong(float value, float low, float scale) {
  const float place = (value - low) * scale;
  return spread(
      static_cast<std::uint32_t>(static_cast<std::int32_t>(place < kCells - 1 ? place : kCells - 1)));
}

BOXGRASP_SIMD void cellsOf(const float* x, const float* y, const float* z, std::size_t n, const Grid& grid,
                           std::uint32_t* cells) {
  const Grid g = grid;
  for (std::size_t i = 0; i < n; ++i) {
    cells[i] = cellAlong(x[i], g.low[0], g.scale) << 2 | cellAlong(y[i], g.low[1], g.scale) << 1 |
               cellAlong(z[i], g.low[2], g.scale);
  }
}

}  // namespace z_order_passes

namespace {

using z_order_passes::Grid;
using z_order_passes::kCells;

std::vector<std::uint32_t> cellsOf(const PointCloud& cloud) {
  const Eigen::AlignedBox3d box = bounds(cloud);
  const Eigen::Vector3f low = box.min().cast<float>();
  const Grid grid{{low.x(), low.y(), low.z()},
                  static_cast<float>(kCells / std::max(box.sizes().maxCoeff(), 1e-30))};
  std::vector<std::uint32_t> cells(cloud.size());
  z_order_passes::cellsOf(cloud.x.data(), cloud.y.data(), cloud.z.data(), cloud.size(), grid, cells.data());
  return cells;
}

}  // namespace

std::vector<std::uint32_t> zOrder(const PointCloud& cloud) {
  if (cloud.empty()) return {};
  const std::vector<std::uint32_t> cells = cellsOf(cloud);
  std::vector<std::uint32_t> begin(kCells * kCells * kCells + 1, 0);
  for (const std::uint32_t cell : cells) ++begin[cell + 1];
  for (std::size_t cell = 1; cell < begin.size(); ++cell) begin[cell] += begin[cell - 1];
  std::vector<std::uint32_t> order(cloud.size());
  for (std::size_t i = 0; i < cells.size(); ++i) order[begin[cells[i]]++] = static_cast<std::uint32_t>(i);
  return order;
}

}  // namespace boxgrasp
