// Taking a scene apart: the supporting plane and the objects on it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

struct SceneOptions {
  // Never take apart: the cloud is one object. For clouds cut out beforehand.
  bool whole = false;
  // Points nearer to the plane than this may belong to it: above the noise and bow of a Kinect's table. An
  // object must rise higher than this; its foot is taken off only as high as the noise around the plane
  // reaches.
  double plane_distance_m = 0.010;
  // A plane patch with fewer of the points than this is not a table; points of larger planes tried before do
  // not count.
  double min_plane_fraction = 0.25;
  // A plane patch whose second extent is below this is an object's side, not a table.
  double min_plane_extent_m = 0.30;
  // Points nearer than this belong to one object. Below the gaps between objects, above the sensor's spacing.
  double cluster_distance_m = 0.020;
  // Smaller clusters are left aside, and counted.
  std::size_t min_cluster_points = 150;
  // Larger clusters are background (walls, floor), and counted.
  double max_object_extent_m = 0.60;
  // Of the random sampling that finds the plane.
  std::uint64_t seed = 1;
  int threads = 1;  // 0 = all cores; the result does not depend on it
  void validate() const;
};

struct Plane {
  Vector3d normal_C = Vector3d::Zero();  // unit; points to the side on which the objects stand
  double offset_m = 0.0;                 // normal_C.p = offset_m on the plane
};

struct Scene {
  std::optional<Plane> table;
  bool isolated = false;                            // the cloud is one object, left whole
  std::vector<std::vector<std::uint32_t>> objects;  // point indices, ascending; the largest object first
  // Every point is counted once: in an object or in one of these.
  std::size_t table_points = 0, background_points = 0, small_cluster_points = 0;
};

// Finds the plane on which objects stand and the clusters that stand on it. Planes are found by random sample
// consensus and refined by least squares, the largest first; clusters are connected by steps of
// cluster_distance_m, as in PCL's SACSegmentation and EuclideanClusterExtraction, but in an order that
// depends on where the points are alone: the same points and seed give the same objects however the points
// were ordered. A plane patch whose clusters lie around its border or cover most of it is the side of an
// object and not a table. Objects that touch are found as one. A cloud with no table and one cluster is
// isolated and left whole. `viewpoint_C`, if known, orients the plane; else objects say where above is. A
// known `table` (unit normal) is not looked for: what rises over it, wherever, stands on it, and so does a
// cloud that is left whole. Pre: finite and not empty.
Scene takeApart(const PointCloud& cloud_C, const SceneOptions& options = {}, const StopToken& stop = {},
                const std::optional<Vector3d>& viewpoint_C = std::nullopt,
                const std::optional<Plane>& table = std::nullopt);

}  // namespace boxgrasp
