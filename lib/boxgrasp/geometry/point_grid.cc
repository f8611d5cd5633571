#include "boxgrasp/geometry/point_grid.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

namespace boxgrasp {
namespace {

constexpr int kBits = 21;  // of a cell's index along one axis
constexpr int kReach = 1 << (kBits - 1);

// The median along each axis of a few points: among the bulk of the cloud even when there are outliers.
Vector3d typicalPoint(const PointCloud& cloud) {
  const std::size_t n = std::min<std::size_t>(cloud.size(), 63);
  Vector3d median = Vector3d::Zero();
  std::vector<double> values(n);
  for (int axis = 0; axis < 3 && n > 0; ++axis) {
    for (std::size_t i = 0; i < n; ++i) values[i] = cloud.point(i * cloud.size() / n)[axis];
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n / 2), values.end());
    median[axis] = values[n / 2];
  }
  return median;
}

Eigen::AlignedBox3d boxAroundSphere(const Vector3d& center, double radius) {
  return {center.array() - radius, center.array() + radius};
}

}  // namespace

PointGrid::PointGrid(const PointCloud& cloud, double cell_m)
    : cloud_(&cloud), cell_m_(cell_m), origin_(typicalPoint(cloud)), order_(cloud.size()) {
  assert(cell_m > 0.0);
  slots_.resize(std::bit_ceil(2 * cloud.size() + 1));
  std::vector<std::uint32_t> cell_of_point(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::uint64_t key = keyOf(cellOf(cloud.point(i)));
    // Points that follow each other are often neighbours.
    const bool again = i > 0 && keys_[cell_of_point[i - 1]] == key;
    cell_of_point[i] = again ? cell_of_point[i - 1] : insert(key);
    ++cells_[cell_of_point[i]].end;
  }
  std::uint32_t begin = 0;
  for (Cell& cell : cells_) {
    cell.begin = begin;
    begin += cell.end;
    cell.end = cell.begin;
  }
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    order_[cells_[cell_of_point[i]].end++] = static_cast<std::uint32_t>(i);
  }
}

PointGrid::Index PointGrid::cellOf(const Vector3d& p) const {
  const Vector3d cells = ((p - origin_) / cell_m_).array().floor();
  return cells.cwiseMax(-kReach).cwiseMin(kReach - 1).cast<int>();
}

std::uint64_t PointGrid::keyOf(const Index& cell) {
  const auto part = [&](int axis) { return static_cast<std::uint64_t>(cell[axis] + kReach); };
  return part(0) | part(1) << kBits | part(2) << (2 * kBits);
}

PointGrid::Index PointGrid::indexOf(std::uint64_t key) {
  const auto part = [&](int axis) {
    return static_cast<int>(key >> (axis * kBits) & (2 * kReach - 1)) - kReach;
  };
  return {part(0), part(1), part(2)};
}

std::size_t PointGrid::slotOf(std::uint64_t key) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = (key * 0x9E3779B97F4A7C15u >> 32) & mask;  // Fibonacci hashing
  while (slots_[slot] != 0 && keys_[slots_[slot] - 1] != key) slot = (slot + 1) & mask;
  return slot;
}

std::uint32_t PointGrid::insert(std::uint64_t key) {
  std::uint32_t& slot = slots_[slotOf(key)];
  if (slot == 0) {
    keys_.push_back(key);
    cells_.emplace_back();
    slot = static_cast<std::uint32_t>(keys_.size());
  }
  return slot - 1;
}

const PointGrid::Cell* PointGrid::find(const Index& cell) const {
  const std::uint32_t number = slots_[slotOf(keyOf(cell))];
  return number == 0 ? nullptr : &cells_[number - 1];
}

std::vector<std::uint32_t> PointGrid::within(const Vector3d& p, double radius_m) const {
  std::vector<std::uint32_t> found;
  visitBox(boxAroundSphere(p, radius_m), [&](std::uint32_t i) {
    if ((cloud_->point(i) - p).squaredNorm() <= radius_m * radius_m) found.push_back(i);
    return false;
  });
  std::sort(found.begin(), found.end());
  return found;
}

std::optional<std::uint32_t> PointGrid::nearest(const Vector3d& p, double radius_m) const {
  // A growing sphere: the nearest point in it is the nearest of all once it lies inside. Most that are asked
  // for are much nearer than a cell is wide.
  for (double radius = std::min(0.25 * cell_m_, radius_m);; radius = std::min(2.0 * radius, radius_m)) {
    std::optional<std::uint32_t> best;
    double best_squared = radius * radius;
    visitBox(boxAroundSphere(p, radius), [&](std::uint32_t i) {
      const double squared = (cloud_->point(i) - p).squaredNorm();
      if (squared < best_squared || (squared == best_squared && (!best || i < *best))) {
        best = i;
        best_squared = squared;
      }
      return false;
    });
    if (best || radius >= radius_m) return best;
  }
}

}  // namespace boxgrasp
