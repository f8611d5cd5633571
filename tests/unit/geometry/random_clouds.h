// Random clouds for the tests of this room.
#pragma once

#include <algorithm>

#include "boxgrasp/base/random.h"
#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp::test {

// n points, normally distributed with the given standard deviations along x, y and z.
inline PointCloud gaussianCloud(std::size_t n, const Vector3d& deviations, std::mt19937_64& random) {
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = normal(random), y = normal(random);
    cloud.push(deviations.cwiseProduct(Vector3d(x, y, normal(random))));
  }
  return cloud;
}

// n points spread evenly in a box around the origin.
inline PointCloud boxCloud(std::size_t n, const Vector3d& extents, std::mt19937_64& random) {
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = uniform(random, -0.5, 0.5), y = uniform(random, -0.5, 0.5);
    cloud.push(extents.cwiseProduct(Vector3d(x, y, uniform(random, -0.5, 0.5))));
  }
  return cloud;
}

// The same points in another order.
inline PointCloud shuffled(const PointCloud& cloud, std::mt19937_64& random) {
  std::vector<std::uint32_t> order(cloud.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[uniformIndex(random, i)]);
  return select(cloud, order);
}

}  // namespace boxgrasp::test
