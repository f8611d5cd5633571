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
// 1 in size and is rounded to a multiple of 2^-30, so 2^32 of them fit. Powers of two are put into the
// coordinates, so that sums, products and cubes need no other factor.
namespace canonical_sums {

constexpr double kOne = 0x1p30;
constexpr double kRootOfOne = 0x1p15, kCubeRootOfOne = 0x1p10;
// Adding it to a double of size below 2^51 leaves the nearest integer in the low bits of the result: a
// rounding that vectorises.
constexpr double kShift = 0x1.8p52;

// The nearest integer, and the bits of kShift: they are taken off the sum.
inline std::uint64_t shifted(double value) { return std::bit_cast<std::uint64_t>(value + kShift); }

inline std::int64_t unshifted(std::uint64_t sum, std::size_t summands) {
  return static_cast<std::int64_t>(sum - summands * std::bit_cast<std::uint64_t>(kShift));
}

struct Origin {
  double x, y, z;
  double scale;  // brings every |p - origin| component to 1 or less
};

using Moments = std::array<std::int64_t, 9>;  // x, y, z, xx, xy, xz, yy, yz, zz

BOXGRASP_SIMD Moments secondMoments(const float* px, const float* py, const float* pz, std::size_t n,
                                    const Origin& origin) {
  const Origin o = origin;
  const double scale = o.scale * kRootOfOne;
  std::uint64_t sx = 0, sy = 0, sz = 0, sxx = 0, sxy = 0, sxz = 0, syy = 0, syz = 0, szz = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = (px[i] - o.x) * scale, y = (py[i] - o.y) * scale, z = (pz[i] - o.z) * scale;
    sx += shifted(x * kRootOfOne);
    sy += shifted(y * kRootOfOne);
    sz += shifted(z * kRootOfOne);
    sxx += shifted(x * x);
    sxy += shifted(x * y);
    sxz += shifted(x * z);
    syy += shifted(y * y);
    syz += shifted(y * z);
    szz += shifted(z * z);
  }
  Moments moments{};
  const std::array sums{sx, sy, sz, sxx, sxy, sxz, syy, syz, szz};
  for (std::size_t i = 0; i < sums.size(); ++i) moments[i] = unshifted(sums[i], n);
  return moments;
}

struct Direction {
  double x, y, z;
};

// The sums of (d.(p - origin))^3 for two directions d, unit vectors times the scale.
BOXGRASP_SIMD std::array<std::int64_t, 2> thirdMoments(const float* px, const float* py, const float* pz,
                                                       std::size_t n, const Origin& origin,
                                                       const Direction& first, const Direction& second) {
  const Origin o = origin;
  const Direction a{first.x * kCubeRootOfOne, first.y * kCubeRootOfOne, first.z * kCubeRootOfOne};
  const Direction b{second.x * kCubeRootOfOne, second.y * kCubeRootOfOne, second.z * kCubeRootOfOne};
  std::uint64_t sum_a = 0, sum_b = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = px[i] - o.x, y = py[i] - o.y, z = pz[i] - o.z;
    const double s = a.x * x + a.y * y + a.z * z, t = b.x * x + b.y * y + b.z * z;
    sum_a += shifted(s * s * s);
    sum_b += shifted(t * t * t);
  }
  return {unshifted(sum_a, n), unshifted(sum_b, n)};
}

}  // namespace canonical_sums

namespace {

using canonical_sums::Direction;
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
  const auto scaled = [&](const Vector3d& axis) {
    return Direction{axis.x() * origin.scale, axis.y() * origin.scale, axis.z() * origin.scale};
  };
  const auto skewness =
      canonical_sums::thirdMoments(cloud_C.x.data(), cloud_C.y.data(), cloud_C.z.data(), cloud_C.size(),
                                   origin, scaled(vectors.col(2)), scaled(vectors.col(1)));
  for (int i = 0; i < 2; ++i) {
    const Vector3d axis = vectors.col(2 - i);
    axes.col(i) = skewness[static_cast<std::size_t>(i)] < 0 ? Vector3d(-axis) : axis;
  }
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return makePose(axes, mean);
}

}  // namespace boxgrasp
