// Triangle meshes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// Vertices in metres; triangles index them, counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// n points spread evenly by area over the surface, one in each of n equal shares of it, in the order of the
// triangles. The same seed gives the same points. Pre: the triangles index existing vertices. Throws
// InputError when the mesh has no triangle of positive area.
PointCloud sampleSurface(const TriangleMesh& mesh, std::size_t n, std::uint64_t seed);

}  // namespace boxgrasp
