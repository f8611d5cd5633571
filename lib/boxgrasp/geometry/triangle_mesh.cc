#include "boxgrasp/geometry/triangle_mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"

namespace boxgrasp {
namespace {

double area(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const Vector3d& a = mesh.vertices[triangle[0]];
  return 0.5 * (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a).norm();
}

// Running sum of the triangles' areas.
std::vector<double> areasUpTo(const TriangleMesh& mesh) {
  std::vector<double> sums;
  sums.reserve(mesh.triangles.size());
  double sum = 0.0;
  for (const auto& triangle : mesh.triangles) sums.push_back(sum += area(mesh, triangle));
  if (!(sum > 0.0) || !std::isfinite(sum)) {
    throw InputError(
        fmt::format("a mesh of {} triangles has the surface area {} m^2 and cannot be sampled; give it at "
                    "least one triangle of positive area with finite vertices",
                    mesh.triangles.size(), sum));
  }
  return sums;
}

Vector3d pointIn(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& triangle,
                 std::mt19937_64& random) {
  const double s = std::sqrt(uniform(random)), t = uniform(random);
  return (1.0 - s) * mesh.vertices[triangle[0]] + s * (1.0 - t) * mesh.vertices[triangle[1]] +
         s * t * mesh.vertices[triangle[2]];
}

}  // namespace

PointCloud sampleSurface(const TriangleMesh& mesh, std::size_t n, std::uint64_t seed) {
  const std::vector<double> sums = areasUpTo(mesh);
  std::mt19937_64 random(seed);
  PointCloud cloud;
  cloud.reserve(n);
  std::size_t at = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double target = sums.back() * (static_cast<double>(i) + uniform(random)) / static_cast<double>(n);
    while (at + 1 < sums.size() && sums[at] <= target) ++at;
    cloud.push(pointIn(mesh, mesh.triangles[at], random));
  }
  return cloud;
}

}  // namespace boxgrasp
