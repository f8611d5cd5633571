// Taking a scene apart: the supporting plane and the objects on it.
#pragma once

#include <optional>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

struct SceneOptions {
  bool whole = false;                  // never take apart: the cloud is one object
  double plane_distance_m = 0.010;     // points nearer to the plane than this belong to it
  double min_plane_fraction = 0.25;    // a plane with fewer of the points than this is not a table
  double min_plane_extent_m = 0.30;    // a plane patch whose second extent is below this is an object's side, not a table
  double cluster_distance_m = 0.020;   // points nearer than this belong to one object
  std::size_t min_cluster_points = 150;   // smaller clusters are left aside, and counted
  double max_object_extent_m = 0.60;   // larger clusters are background (walls, floor), and counted
  std::uint64_t seed = 1;              // of the random sampling that finds the plane
  void validate() const;
};

struct Plane {
  Vector3d normal_C = Vector3d::Zero();  // unit; points to the side on which the objects stand
  double offset_m = 0.0;                 // normal_C.p = offset_m on the plane
};

struct Scene {
  std::optional<Plane> table;
  bool isolated = false;                                // the cloud is one object, left whole
  std::vector<std::vector<std::uint32_t>> objects;      // point indices, ascending; the largest object first
  std::size_t table_points = 0, background_points = 0, small_cluster_points = 0;
};

// Finds the dominant plane (PCL sample consensus) and the clusters above it (PCL Euclidean clustering, or better). A cloud with no table
// and one cluster is isolated and left whole. `viewpoint_C`, if known, orients the plane; else objects say where above is.
// Pre: finite.
Scene takeApart(const PointCloud& cloud_C, const SceneOptions& options = {}, const StopToken& stop = {},
                const std::optional<Vector3d>& viewpoint_C = std::nullopt);

}  // namespace boxgrasp
