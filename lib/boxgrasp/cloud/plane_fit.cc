#include "boxgrasp/cloud/plane_fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "boxgrasp/base/parallel.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/base/simd.h"

namespace boxgrasp {

namespace plane_passes {

// How many of n points are within a distance of the plane normal . p = offset.
BOXGRASP_SIMD std::uint32_t countWithin(const float* x, const float* y, const float* z, std::size_t n,
                                        const double* normal, double offset, double distance) {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double height = normal[0] * x[i] + (normal[1] * y[i] + normal[2] * z[i]) - offset;
    count += std::abs(height) <= distance ? 1u : 0u;
  }
  return count;
}

}  // namespace plane_passes

namespace {

// Every n-th index, so that about `most` remain.
std::vector<std::uint32_t> thinned(const std::vector<std::uint32_t>& indices, std::size_t most) {
  const std::size_t step = (indices.size() + most - 1) / most;
  std::vector<std::uint32_t> some;
  for (std::size_t i = 0; i < indices.size(); i += step) some.push_back(indices[i]);
  return some;
}

// The plane through three points; its normal is zero when they lie on a line.
Plane planeThrough(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a);
  if (normal.norm() < 1e-12) return {};
  const Vector3d unit = normal.normalized();
  return {unit, unit.dot(a)};
}

std::size_t countWithin(const Plane& plane, const PointCloud& cloud, double distance_m) {
  return plane_passes::countWithin(cloud.x.data(), cloud.y.data(), cloud.z.data(), cloud.size(),
                                   plane.normal_C.data(), plane.offset_m, distance_m);
}

Plane bestOfSamples(const PointCloud& cloud, double distance_m, std::mt19937_64& random, int threads,
                    const StopToken& stop) {
  // A plane that holds a fifth of the points is missed once in 3,000 times.
  constexpr std::size_t kTrials = 1000, kStretch = 50;
  std::vector<Plane> planes(kTrials);
  for (Plane& plane : planes) {
    const auto draw = [&] { return cloud.point(uniformIndex(random, cloud.size())); };
    const Vector3d a = draw(), b = draw(), c = draw();
    plane = planeThrough(a, b, c);
  }
  std::vector<std::size_t> counts(kTrials, 0);
  parallelFor(kTrials / kStretch, threads, [&](std::size_t stretch) {
    stop.check();
    for (std::size_t i = stretch * kStretch; i < (stretch + 1) * kStretch; ++i) {
      if (!planes[i].normal_C.isZero()) counts[i] = countWithin(planes[i], cloud, distance_m);
    }
  });
  return planes[static_cast<std::size_t>(std::ranges::max_element(counts) - counts.begin())];
}

// The least squares plane through the points near the given one.
Plane refined(const Plane& plane, const PointCloud& cloud, double distance_m) {
  Vector3d sum = Vector3d::Zero();
  Matrix3d squares = Matrix3d::Zero();
  double n = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3d p = cloud.point(i);
    if (std::abs(heightAbove(plane, p)) > distance_m) continue;
    sum += p;
    squares += p * p.transpose();
    n += 1.0;
  }
  if (n < 3.0) return plane;
  const Vector3d mean = sum / n;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(squares / n - mean * mean.transpose());
  const Vector3d normal = axes.eigenvectors().col(0);
  return {normal, normal.dot(mean)};
}

}  // namespace

Plane dominantPlane(const PointCloud& cloud_C, const std::vector<std::uint32_t>& among, double distance_m,
                    std::mt19937_64& random, int threads, const StopToken& stop) {
  assert(among.size() >= 3);
  constexpr std::size_t kCounted = 2000;
  constexpr int kRefinements = 5;
  Plane plane = bestOfSamples(select(cloud_C, thinned(among, kCounted)), distance_m, random, threads, stop);
  const PointCloud all = select(cloud_C, among);
  for (int i = 0; i < kRefinements; ++i) plane = refined(plane, all, distance_m);
  return plane;
}

double noiseAround(const Plane& plane, const PointCloud& cloud_C, double distance_m) {
  double squares = 0.0, n = 0.0;
  for (std::size_t i = 0; i < cloud_C.size(); ++i) {
    const double height = heightAbove(plane, cloud_C.point(i));
    if (std::abs(height) > distance_m) continue;
    squares += height * height;
    n += 1.0;
  }
  return n > 0.0 ? std::sqrt(squares / n) : 0.0;
}

}  // namespace boxgrasp
