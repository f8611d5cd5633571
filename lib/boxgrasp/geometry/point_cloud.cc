#include "boxgrasp/geometry/point_cloud.h"

#include <algorithm>
#include <cassert>

#include "boxgrasp/base/simd.h"
#include "boxgrasp/geometry/block_ranges.h"

namespace boxgrasp {

namespace point_cloud_passes {

constexpr std::size_t kLanes = 32;

// Smallest and largest dot product of a point with (a, b, c).
BOXGRASP_SIMD Interval rangeAlong(const float* x, const float* y, const float* z, std::size_t n, double a,
                                  double b, double c) {
  double low[kLanes], high[kLanes];
  std::fill_n(low, kLanes, Interval{}.min);
  std::fill_n(high, kLanes, Interval{}.max);
  const std::size_t whole = n - n % kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      const double value = a * x[i + k] + b * y[i + k] + c * z[i + k];
      low[k] = value < low[k] ? value : low[k];
      high[k] = value > high[k] ? value : high[k];
    }
  }
  for (std::size_t i = whole; i < n; ++i) {
    const double value = a * x[i] + b * y[i] + c * z[i];
    low[0] = std::min(low[0], value);
    high[0] = std::max(high[0], value);
  }
  return {*std::min_element(low, low + kLanes), *std::max_element(high, high + kLanes)};
}

// out = r.(x, y, z) + t for every point: one row of a pose.
BOXGRASP_SIMD void transformRow(const float* x, const float* y, const float* z, std::size_t n,
                                const double* r, double t, float* out) {
  const double a = r[0], b = r[1], c = r[2];
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<float>(a * x[i] + b * y[i] + c * z[i] + t);
}

}  // namespace point_cloud_passes

void PointCloud::reserve(std::size_t n) {
  x.reserve(n);
  y.reserve(n);
  z.reserve(n);
}

void PointCloud::resize(std::size_t n) {
  x.resize(n);
  y.resize(n);
  z.resize(n);
}

void PointCloud::push(const Vector3d& p) {
  x.push_back(static_cast<float>(p.x()));
  y.push_back(static_cast<float>(p.y()));
  z.push_back(static_cast<float>(p.z()));
}

PointCloud select(const PointCloud& cloud, const std::vector<std::uint32_t>& indices) {
  PointCloud selected;
  selected.resize(indices.size());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    assert(indices[i] < cloud.size());
    selected.x[i] = cloud.x[indices[i]];
    selected.y[i] = cloud.y[indices[i]];
    selected.z[i] = cloud.z[indices[i]];
  }
  return selected;
}

PointCloud joined(PointCloud first, const PointCloud& second) {
  first.x.insert(first.x.end(), second.x.begin(), second.x.end());
  first.y.insert(first.y.end(), second.y.begin(), second.y.end());
  first.z.insert(first.z.end(), second.z.begin(), second.z.end());
  return first;
}

Vector3d meanOf(const PointCloud& cloud) {
  assert(!cloud.empty());
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < cloud.size(); ++i) sum += cloud.point(i);
  return sum / static_cast<double>(cloud.size());
}

PointCloud transformed(const PointCloud& cloud_A, const Pose& X_BA) {
  PointCloud cloud_B;
  cloud_B.resize(cloud_A.size());
  float* const out[3] = {cloud_B.x.data(), cloud_B.y.data(), cloud_B.z.data()};
  for (int row = 0; row < 3; ++row) {
    const Vector3d r = X_BA.linear().row(row);
    point_cloud_passes::transformRow(cloud_A.x.data(), cloud_A.y.data(), cloud_A.z.data(), cloud_A.size(),
                                     r.data(), X_BA.translation()[row], out[row]);
  }
  return cloud_B;
}

Eigen::AlignedBox3d bounds(const PointCloud& cloud) {
  const ValueRange x = rangeOf(cloud.x), y = rangeOf(cloud.y), z = rangeOf(cloud.z);
  return {Vector3d(x.min, y.min, z.min), Vector3d(x.max, y.max, z.max)};
}

Interval rangeAlong(const PointCloud& cloud, std::size_t begin, std::size_t end, const Vector3d& direction) {
  return point_cloud_passes::rangeAlong(&cloud.x[begin], &cloud.y[begin], &cloud.z[begin], end - begin,
                                        direction.x(), direction.y(), direction.z());
}

AxisRanges rangesAlong(const PointCloud& cloud, const Matrix3d& axes) {
  AxisRanges ranges;
  for (int i = 0; i < 3; ++i) {
    const Interval range = rangeAlong(cloud, 0, cloud.size(), axes.col(i));
    ranges.min[i] = range.min;
    ranges.max[i] = range.max;
  }
  return ranges;
}

}  // namespace boxgrasp
