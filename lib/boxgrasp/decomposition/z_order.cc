#include "boxgrasp/decomposition/z_order.h"

#include <algorithm>

namespace boxgrasp {
namespace {

constexpr std::uint32_t kBits = 5;
constexpr std::uint32_t kCells = 1u << kBits;

// Leaves two empty bits between the bits of a number.
std::uint32_t spread(std::uint32_t number) {
  std::uint32_t result = 0;
  for (std::uint32_t bit = 0; bit < kBits; ++bit) result |= (number >> bit & 1u) << 3 * bit;
  return result;
}

std::array<std::uint32_t, kCells> spreadTable() {
  std::array<std::uint32_t, kCells> table;
  for (std::uint32_t i = 0; i < kCells; ++i) table[i] = spread(i);
  return table;
}

std::vector<std::uint32_t> cellsOf(const PointCloud& cloud) {
  const Eigen::AlignedBox3d box = bounds(cloud);
  const double scale = kCells / std::max(box.sizes().maxCoeff(), 1e-30);
  const auto table = spreadTable();
  const auto place = [&](float value, double low) {
    return table[std::min(kCells - 1, static_cast<std::uint32_t>((value - low) * scale))];
  };
  std::vector<std::uint32_t> cells(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cells[i] = place(cloud.x[i], box.min().x()) << 2 | place(cloud.y[i], box.min().y()) << 1 |
               place(cloud.z[i], box.min().z());
  }
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
