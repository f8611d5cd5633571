// The samples of a distance field.
#pragma once

#include <vector>

#include "boxgrasp/geometry/triangle_mesh.h"

namespace boxgrasp {

// A box of samples: the one of index (x, y, z) is at origin + cell * (x, y, z), and x runs fastest.
struct SampleGrid {
  Vector3d origin = Vector3d::Zero();
  double cell = 0.0;
  Eigen::Vector3i size = Eigen::Vector3i::Zero();

  std::size_t count() const { return std::size_t(size.x()) * size.y() * size.z(); }
  std::size_t index(const Eigen::Vector3i& at) const {
    return (std::size_t(at.z()) * size.y() + at.y()) * size.x() + at.x();
  }
  Vector3d position(const Eigen::Vector3i& at) const { return origin + cell * at.cast<double>(); }
  bool contains(const Eigen::Vector3i& at) const {
    return (at.array() >= 0).all() && (at.array() < size.array()).all();
  }
};

// The point of the triangle that is nearest to p.
Vector3d closestPoint(const std::array<Vector3d, 3>& triangle, const Vector3d& p);

// The signed distances of the samples to the mesh's surface: negative inside. Pre: the mesh bounds a solid
// and lies inside the grid.
std::vector<float> signedDistances(const TriangleMesh& mesh, const SampleGrid& grid);

}  // namespace boxgrasp
