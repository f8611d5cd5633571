// Rays against meshes (Embree).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "boxgrasp/geometry/triangle_mesh.h"

struct RTCSceneTy;

namespace boxgrasp {

struct RayHit {
  double distance = -1.0;              // in lengths of the ray's direction
  std::size_t mesh = 0;                // number of the mesh
  Vector3d normal = Vector3d::Zero();  // unit, of the triangle as it is oriented
};

// Meshes that stand still, in one frame, in metres. Immutable: all threads may share one.
class RayCaster {
 public:
  // Pre: the triangles index existing vertices, which are finite.
  explicit RayCaster(std::vector<TriangleMesh> meshes);

  // Where the ray first meets a mesh, from either side. Which triangle is found in single precision; where
  // the ray meets its plane is exact.
  std::optional<RayHit> first(const Vector3d& origin, const Vector3d& direction) const;

  // Whether a mesh is between the points, `margin` metres off either of them.
  bool blocked(const Vector3d& from, const Vector3d& to, double margin) const;

 private:
  std::vector<TriangleMesh> meshes_;
  std::shared_ptr<RTCSceneTy> scene_;
};

}  // namespace boxgrasp
