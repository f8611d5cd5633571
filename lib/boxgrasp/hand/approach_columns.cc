#include "boxgrasp/hand/approach_columns.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>

namespace boxgrasp {
namespace {

constexpr double kColumn_m =
    0.004;  // side of a column: half a link's radius, so that few points beside a link are looked at

// The axis-aligned box in C around a box in A.
Eigen::AlignedBox3d around(const Eigen::AlignedBox3d& box_A, const Pose& X_CA) {
  const Vector3d center_C = X_CA * box_A.center();
  const Vector3d half_C = X_CA.linear().cwiseAbs() * (0.5 * box_A.sizes());
  return {center_C - half_C, center_C + half_C};
}

}  // namespace

ApproachColumns::ApproachColumns(const PointGrid& scene_C, const Pose& X_CA,
                                 const Eigen::AlignedBox3d& region_A)
    : X_CA_(X_CA) {
  assert(!region_A.isEmpty() && region_A.sizes().allFinite());
  const Pose X_AC = X_CA.inverse();
  std::vector<Eigen::Vector3f> points_A;
  Eigen::AlignedBox3d bounds_A;
  scene_C.visitBox(around(region_A, X_CA), [&](std::uint32_t i) {
    const Vector3d p_A = X_AC * scene_C.cloud().point(i);
    if (region_A.contains(p_A)) {
      points_A.push_back(p_A.cast<float>());
      bounds_A.extend(p_A);
    }
    return false;
  });
  if (points_A.empty()) bounds_A.extend(region_A.center());
  origin_ = bounds_A.min().head<2>();
  nx_ = 1 + static_cast<int>(bounds_A.sizes().x() / kColumn_m);
  ny_ = 1 + static_cast<int>(bounds_A.sizes().y() / kColumn_m);
  sortIntoColumns(points_A);
}

// Points beyond the outermost columns belong to these.
int ApproachColumns::clampedColumn(double offset_m, int count) const {
  return static_cast<int>(std::clamp(std::floor(offset_m / kColumn_m), 0.0, count - 1.0));
}

std::size_t ApproachColumns::columnOf(const Eigen::Vector3f& p_A) const {
  const int i = clampedColumn(p_A.x() - origin_.x(), nx_), j = clampedColumn(p_A.y() - origin_.y(), ny_);
  return static_cast<std::size_t>(j) * nx_ + i;
}

void ApproachColumns::sortIntoColumns(const std::vector<Eigen::Vector3f>& points_A) {
  begin_.assign(static_cast<std::size_t>(nx_) * ny_ + 1, 0);
  for (const auto& p_A : points_A) ++begin_[columnOf(p_A) + 1];
  for (std::size_t column = 1; column < begin_.size(); ++column) begin_[column] += begin_[column - 1];
  points_A_.resize(points_A.size());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (const auto& p_A : points_A) points_A_[next[columnOf(p_A)]++] = p_A;
  for (std::size_t column = 0; column + 1 < begin_.size(); ++column) {
    std::sort(points_A_.begin() + begin_[column], points_A_.begin() + begin_[column + 1],
              [](const auto& p, const auto& q) {
                return std::make_tuple(p.z(), p.x(), p.y()) < std::make_tuple(q.z(), q.x(), q.y());
              });
  }
}

}  // namespace boxgrasp
