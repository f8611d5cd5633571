#include "boxgrasp/geometry/canonical_frame.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include "boxgrasp/base/simd.h"

namespace boxgrasp {

// Sums of fixed-point numbers: integers add up to the same total in any order. Every summand is at most 1 in
// size and is rounded to a multiple of 2^-21.
namespace canonical_sums {

constexpr float kOne = 0x1p21f;
// Adding it to a float of size below 2^22 leaves the nearest integer in the low bits of the result: a
// rounding that vectorises.
constexpr float kShift = 0x1.8p23f;
constexpr std::size_t kRun = 512;  // so many summands fit into 32 bits

// The nearest integer, and the bits of kShift: they are taken off the sum.
BOXGRASP_SIMD_PART std::uint32_t shifted(float value) { return std::bit_cast<std::uint32_t>(value + kShift); }

BOXGRASP_SIMD_PART std::int64_t unshifted(std::uint32_t sum, std::size_t summands) {
  return static_cast<std::int32_t>(sum - static_cast<std::uint32_t>(summands) *
                                             std::bit_cast<std::uint32_t>(kShift));
}

struct Origin {
  float x, y, z;
  float scale;  // brings every |p - origin| component to 1 or less
};

using Moments = std::array<std::int64_t, 9>;  // x, y, z, xx, xy, xz, yy, yz, zz

BOXGRASP_SIMD_PART void addRun(const float* px, const float* py, const float* pz, std::size_t n,
                               const Origin& o, Moments& moments) {
  std::uint32_t sx = 0, sy = 0, sz = 0, sxx = 0, sxy = 0, sxz = 0, syy = 0, syz = 0, szz = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const float x = (px[i] - o.x) * o.scale, y = (py[i] - o.y) * o.scale, z = (pz[i] - o.z) * o.scale;
    const float large_x = x * kOne, large_y = y * kOne, large_z = z * kOne;
    sx += shifted(large_x);
    sy += shifted(large_y);
    sz += shifted(large_z);
    sxx += shifted(large_x * x);
    sxy += shifted(large_x * y);
    sxz += shifted(large_x * z);
    syy += shifted(large_y * y);
    syz += shifted(large_y * z);
    szz += shifted(large_z * z);
  }
  const std::array sums{sx, sy, sz, sxx, sxy, sxz, syy, syz, szz};
  for (std::size_t i = 0; i < sums.size(); ++i) moments[i] += unshifted(sums[i], n);
}

BOXGRASP_SIMD Moments secondMoments(const float* px, const float* py, const float* pz, std::size_t n,
                                    const Origin& origin) {
  const Origin o = origin;
  Moments moments{};
  for (std::size_t i = 0; i < n; i += kRun) addRun(px + i, py + i, pz + i, std::min(kRun, n - i), o, moments);
  return moments;
}

// Unit vector times the scale, and what the true origin has along it.
struct Direction {
  float x, y, z, offset;
};

// The sums of (d.(p - origin))^3 for two directions d.
BOXGRASP_SIMD std::array<std::int64_t, 2> thirdMoments(const float* px, const float* py, const float* pz,
                                                       std::size_t n, const Origin& origin,
                                                       const Direction& first, const Direction& second) {
  const Origin o = origin;
  const Direction a = first, b = second;
  std::array<std::int64_t, 2> moments{};
  for (std::size_t begin = 0; begin < n; begin += kRun) {
    const std::size_t end = std::min(n, begin + kRun);
    std::uint32_t sum_a = 0, sum_b = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const float x = px[i] - o.x, y = py[i] - o.y, z = pz[i] - o.z;
      const float s = a.x * x + a.y * y + a.z * z - a.offset, t = b.x * x + b.y * y + b.z * z - b.offset;
      sum_a += shifted(s * s * (s * kOne));
      sum_b += shifted(t * t * (t * kOne));
    }
    moments[0] += unshifted(sum_a, end - begin);
    moments[1] += unshifted(sum_b, end - begin);
  }
  return moments;
}

}  // namespace canonical_sums

namespace {

using canonical_sums::Direction;
using canonical_sums::Moments;
using canonical_sums::Origin;

// On the grid of the largest coordinates, where differences to it are exact: off it all would be rounded to
// the same side.
Origin originAt(const Vector3d& position, const Eigen::AlignedBox3d& bounds, double scale) {
  int exponent = 0;
  std::frexp(bounds.min().cwiseAbs().cwiseMax(bounds.max().cwiseAbs()).maxCoeff(), &exponent);
  const double step = std::ldexp(1.0, exponent - std::numeric_limits<float>::digits);
  const auto rounded = [&](double value) { return static_cast<float>(std::round(value / step) * step); };
  return {rounded(position.x()), rounded(position.y()), rounded(position.z()), static_cast<float>(scale)};
}

Vector3d positionOf(const Origin& origin) { return {origin.x, origin.y, origin.z}; }

// A power of two that brings a reach to 1 or less, and is a float.
double scaleFor(double reach) {
  int exponent = 0;
  std::frexp(reach, &exponent);
  return std::ldexp(1.0, std::min(-exponent, std::numeric_limits<float>::max_exponent - 1));
}

// The direction as seen from an origin that is the true one but for rounding.
Direction directionFrom(const Origin& rounded, const Vector3d& origin, const Vector3d& axis) {
  const Vector3d scaled = axis * static_cast<double>(rounded.scale);
  return {static_cast<float>(scaled.x()), static_cast<float>(scaled.y()), static_cast<float>(scaled.z()),
          static_cast<float>(scaled.dot(origin - positionOf(rounded)))};
}

Matrix3d covariance(const Moments& sums, double n, const Vector3d& mean) {
  const auto second = [&](int i) { return static_cast<double>(sums[i]) / canonical_sums::kOne / n; };
  Matrix3d moments;
  moments << second(3), second(4), second(5), second(4), second(6), second(7), second(5), second(7),
      second(8);
  return moments - mean * mean.transpose();
}

}  // namespace

Pose canonicalFrame(const PointCloud& cloud_C) { return canonicalFrame(cloud_C, bounds(cloud_C)); }

Pose canonicalFrame(const PointCloud& cloud_C, const Eigen::AlignedBox3d& bounds_C) {
  assert(!cloud_C.empty());
  const float *const x = cloud_C.x.data(), *const y = cloud_C.y.data(), *const z = cloud_C.z.data();
  const double scale = scaleFor(0.5 * bounds_C.sizes().norm());
  const Origin middle = originAt(bounds_C.center(), bounds_C, scale);
  const Moments sums = canonical_sums::secondMoments(x, y, z, cloud_C.size(), middle);
  const double n = static_cast<double>(cloud_C.size());
  const Vector3d scaled_mean =
      Eigen::Map<const Eigen::Matrix<std::int64_t, 3, 1>>(sums.data()).cast<double>() /
      (n * canonical_sums::kOne);
  const Matrix3d vectors =
      Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance(sums, n, scaled_mean)).eigenvectors();
  const Vector3d mean = positionOf(middle) + scaled_mean / scale;
  // Twice the reach from the middle bounds the reach from the mean.
  const Origin origin = originAt(mean, bounds_C, 0.5 * scale);
  const auto skewness = canonical_sums::thirdMoments(x, y, z, cloud_C.size(), origin,
                                                     directionFrom(origin, mean, vectors.col(2)),
                                                     directionFrom(origin, mean, vectors.col(1)));
  Matrix3d axes;
  for (int i = 0; i < 2; ++i) {
    const Vector3d axis = vectors.col(2 - i);
    axes.col(i) = skewness[static_cast<std::size_t>(i)] < 0 ? Vector3d(-axis) : axis;
  }
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return makePose(axes, mean);
}

}  // namespace boxgrasp
