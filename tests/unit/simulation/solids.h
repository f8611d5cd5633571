// Simple solids for the simulator's tests: closed, outward oriented, centred on the origin.
#pragma once

#include <cmath>
#include <numbers>

#include "boxgrasp/geometry/triangle_mesh.h"

namespace boxgrasp {

inline TriangleMesh boxMesh(const Vector3d& sizes) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(
        sizes.cwiseProduct(Vector3d(i & 1, i >> 1 & 1, i >> 2 & 1) - Vector3d::Constant(0.5)));
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

// With `rings` steps from pole to pole.
inline TriangleMesh sphereMesh(double radius, std::uint32_t rings) {
  TriangleMesh mesh;
  const std::uint32_t around = 2 * rings;
  for (std::uint32_t i = 1; i < rings; ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      const double polar = std::numbers::pi * i / rings, turn = std::numbers::pi * j / rings;
      mesh.vertices.push_back(radius * Vector3d(std::sin(polar) * std::cos(turn),
                                                std::sin(polar) * std::sin(turn), std::cos(polar)));
    }
  }
  const std::uint32_t top = around * (rings - 1), bottom = top + 1;
  mesh.vertices.push_back({0, 0, radius});
  mesh.vertices.push_back({0, 0, -radius});
  const auto at = [=](std::uint32_t ring, std::uint32_t j) { return ring * around + j % around; };
  for (std::uint32_t j = 0; j < around; ++j) {
    mesh.triangles.push_back({top, at(0, j), at(0, j + 1)});
    mesh.triangles.push_back({bottom, at(rings - 2, j + 1), at(rings - 2, j)});
    for (std::uint32_t ring = 0; ring + 2 < rings; ++ring) {
      mesh.triangles.push_back({at(ring, j), at(ring + 1, j), at(ring, j + 1)});
      mesh.triangles.push_back({at(ring, j + 1), at(ring + 1, j), at(ring + 1, j + 1)});
    }
  }
  return mesh;
}

}  // namespace boxgrasp
