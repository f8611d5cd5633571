#include "boxgrasp/geometry/canonical_frame.h"

#include <Eigen/Eigenvalues>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {

// Sums of fixed-point numbers: integers add up to the same total in any order. Every summand is at most about
// 1 in size and is rounded to a multiple of 2^-30, so 2^32 of them fit.
namespace canonical_sums {

constexpr double kOne = 0x1p30;
// Adding it to a double of size below 2^51 leaves the nearest integer in the low bits of the result: a
// rounding that vectorises.
constexpr double kShift = 0x1.8p52;

inline std::int64_t fixedPoint(double value) {
  return std::bit_cast<std::int64_t>(value * kOne + kShift) - std::bit_cast<std::int64_t>(kShift);
}

struct Origin {
  double x, y, z;
  double scale;  // brings every |p - origin| component to 1 or less
};

using Moments = std::array<std::int64_t, 9>;  // x, y, z, xx, xy, xz, yy, yz, zz

BOXGRASP_SIMD Moments secondMoments(const float* px, const float* py, const float* pz, std::size_t n,
                                    const Origin& origin) {
  const Origin o = origin;
  std::int64_t sx = 0, sy = 0, sz = 0, sxx = 0, sxy = 0, sxz = 0, syy = 0, syz = 0, szz = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = (px[i] - o.x) * o.scale, y = (py[i] - o.y) * o.scale, z = (pz[i] - o.z) * o.scale;
    sx += fixedPoint(x);
    sy += fixedPoint(y);
    sz += fixedPoint(z);
    sxx += fixedPoint(x * x);
    sxy += fixedPoint(x * y);
    sxz += fixedPoint(x * z);
    syy += fixedPoint(y * y);
    syz += fixedPoint(y * z);
    szz += fixedPoint(z * z);
  }
  return {sx, sy, sz, sxx, sxy, sxz, syy, syz, szz};
}

// The sum of (d.(p - origin))^3, d a unit vector times the scale.
BOXGRASP_SIMD std::int64_t thirdMoment(const float* px, const float* py, const float* pz, std::size_t n,
                                       const Origin& origin, double dx, double dy, double dz) {
  const Origin o = origin;
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = dx * (px[i] - o.x) + dy * (py[i] - o.y) + dz * (pz[i] - o.z);
    sum += fixedPoint(t * t * t);
  }
  return sum;
}

}  // namespace canonical_sums

namespace {

using canonical_sums::Moments;
using canonical_sums::Origin;

// Around the middle of the bounds, scaled by a power of two.
Origin originOf(const PointCloud& cloud) {
  const auto box = bounds(cloud);
  const Vector3d middle = box.center();
  const double reach = 0.5 * box.sizes().norm();
  int exponent = 0;
  std::frexp(reach, &exponent);
  return {middle.x(), middle.y(), middle.z(), std::ldexp(1.0, -exponent)};
}

Matrix3d covariance(const Moments& sums, double n, const Vector3d& mean) {
  const auto second = [&](int i) { return static_cast<double>(sums[i]) / canonical_sums::kOne / n; };
  Matrix3d moments;
  moments << second(3), second(4), second(5), second(4), second(6), second(7), second(5), second(7),
      second(8);
  return moments - mean * mean.transpose();
}

double skewness(const PointCloud& cloud, const Origin& mean, const Vector3d& axis) {
  const Vector3d d = axis * mean.scale;
  return static_cast<double>(canonical_sums::thirdMoment(cloud.x.data(), cloud.y.data(), cloud.z.data(),
                                                         cloud.size(), mean, d.x(), d.y(), d.z()));
}

}  // namespace

Pose canonicalFrame(const PointCloud& cloud_C) {
  assert(!cloud_C.empty());
  const Origin middle = originOf(cloud_C);
  const Moments sums = canonical_sums::secondMoments(cloud_C.x.data(), cloud_C.y.data(), cloud_C.z.data(),
                                                     cloud_C.size(), middle);
  const double n = static_cast<double>(cloud_C.size());
  const Vector3d scaled_mean =
      Eigen::Map<const Eigen::Matrix<std::int64_t, 3, 1>>(sums.data()).cast<double>() /
      (n * canonical_sums::kOne);
  const Matrix3d vectors =
      Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance(sums, n, scaled_mean)).eigenvectors();
  const Vector3d mean = Vector3d(middle.x, middle.y, middle.z) + scaled_mean / middle.scale;
  // Twice the reach from the middle bounds the reach from the mean.
  const Origin origin{mean.x(), mean.y(), mean.z(), 0.5 * middle.scale};
  Matrix3d axes;
  for (int i = 0; i < 2; ++i) {
    const Vector3d axis = vectors.col(2 - i);
    axes.col(i) = skewness(cloud_C, origin, axis) < 0.0 ? Vector3d(-axis) : axis;
  }
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return makePose(axes, mean);
}

}  // namespace boxgrasp
