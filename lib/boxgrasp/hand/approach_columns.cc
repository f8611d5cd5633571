#include "boxgrasp/hand/approach_columns.h"

#include <cassert>
#include <limits>

namespace boxgrasp {
namespace {

// The axis-aligned box in C around a box in A.
Eigen::AlignedBox3d around(const Eigen::AlignedBox3d& box_A, const Pose& X_CA) {
  const Vector3d center_C = X_CA * box_A.center();
  const Vector3d half_C = X_CA.linear().cwiseAbs() * (0.5 * box_A.sizes());
  return {center_C - half_C, center_C + half_C};
}

// Sorts `order` by key, keeping the order of equal keys, in linear time. Returns where each key begins, with
// the end behind.
std::vector<std::uint32_t> sortByKey(const std::vector<std::uint32_t>& keys, std::size_t key_count,
                                     std::vector<std::uint32_t>& order) {
  std::vector<std::uint32_t> begin(key_count + 1, 0);
  for (const std::uint32_t key : keys) ++begin[key + 1];
  for (std::size_t key = 1; key <= key_count; ++key) begin[key] += begin[key - 1];
  std::vector<std::uint32_t> next(begin), sorted(order.size());
  for (const std::uint32_t i : order) sorted[next[keys[i]]++] = i;
  order.swap(sorted);
  return begin;
}

}  // namespace

ApproachColumns::ApproachColumns(const PointGrid& scene_C, const Pose& X_CA,
                                 const Eigen::AlignedBox3d& region_A)
    : X_CA_(X_CA) {
  assert(!region_A.isEmpty() && region_A.sizes().allFinite());
  const Matrix3d R_AC = X_CA.linear().transpose();
  const Vector3d p_AC = -(R_AC * X_CA.translation());
  std::vector<Eigen::Vector3f> points_A;
  Eigen::AlignedBox3d bounds_A;
  scene_C.visitBox(around(region_A, X_CA), [&](std::uint32_t i) {
    const Vector3d p_A = R_AC * scene_C.cloud().point(i) + p_AC;
    if (region_A.contains(p_A)) {
      points_A.push_back(p_A.cast<float>());
      bounds_A.extend(p_A);
    }
    return false;
  });
  if (points_A.empty()) bounds_A.extend(region_A.center());
  sortIntoColumns(points_A, bounds_A);
}

void ApproachColumns::sortIntoColumns(const std::vector<Eigen::Vector3f>& points_A,
                                      const Eigen::AlignedBox3d& bounds_A) {
  origin_ = bounds_A.min().head<2>();
  nx_ = 1 + static_cast<int>(bounds_A.sizes().x() / kColumn_m);
  ny_ = 1 + static_cast<int>(bounds_A.sizes().y() / kColumn_m);
  const int layers = 1 + static_cast<int>(bounds_A.sizes().z() / kLayer_m);
  const std::size_t columns = static_cast<std::size_t>(nx_) * ny_, n = points_A.size();

  std::vector<std::uint32_t> column(n), layer(n), order(n);
  first_.assign(columns, std::numeric_limits<float>::infinity());
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vector3d offset = points_A[i].cast<double>() - bounds_A.min();
    column[i] = cellOf(offset.y(), kColumn_m, ny_) * nx_ + cellOf(offset.x(), kColumn_m, nx_);
    layer[i] = cellOf(offset.z(), kLayer_m, layers);
    order[i] = i;
    first_[column[i]] = std::min(first_[column[i]], points_A[i].z());
  }
  sortByKey(layer, layers, order);
  begin_ = sortByKey(column, columns, order);
  points_A_.reserve(n);
  for (const std::uint32_t i : order) points_A_.push_back(points_A[i]);
}

}  // namespace boxgrasp
