#include "boxgrasp/cloud/scene.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/parallel.h"
#include "boxgrasp/cloud/clusters.h"
#include "boxgrasp/cloud/plane_fit.h"
#include "boxgrasp/geometry/polygon.h"
#include "boxgrasp/geometry/voxels.h"

namespace boxgrasp {

void SceneOptions::validate() const {
  requireOption(plane_distance_m > 0.0 && plane_distance_m <= 1.0, "plane_distance_m", plane_distance_m,
                "in (0, 1]");
  requireOption(min_plane_fraction > 0.0 && min_plane_fraction <= 1.0, "min_plane_fraction",
                min_plane_fraction, "in (0, 1]");
  requireOption(min_plane_extent_m >= 0.0, "min_plane_extent_m", min_plane_extent_m, "0 or more");
  requireOption(cluster_distance_m >= 1e-4 && cluster_distance_m <= 1.0, "cluster_distance_m",
                cluster_distance_m, "in [0.0001, 1]");
  requireOption(max_object_extent_m > 0.0, "max_object_extent_m", max_object_extent_m, "above 0");
  requireOption(threads >= 0, "threads", threads, "at least 0");
}

namespace {

using Indices = std::vector<std::uint32_t>;

// A flat patch of the scene: its plane, a frame T with x and y in the plane and z along the normal, and its
// outline there.
struct Patch {
  Plane plane;
  Pose X_TC = Pose::Identity();
  Polygon outline;
  std::size_t points = 0;

  Vector2d foot(const Vector3d& p_C) const { return (X_TC * p_C).head<2>(); }
};

Pose planeFrame(const Plane& plane) {
  const Vector3d x = plane.normal_C.unitOrthogonal();
  const Matrix3d axes = (Matrix3d() << x, plane.normal_C.cross(x), plane.normal_C).finished();
  return makePose(axes, plane.normal_C * plane.offset_m).inverse();
}

// How far inside a counter-clockwise convex outline a point lies; negative outside, then a lower bound of the
// distance.
double depthInside(const Polygon& outline, const Vector2d& p) {
  double depth = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2d& a = outline[i];
    const Vector2d edge = outline[(i + 1) % outline.size()] - a;
    depth = std::min(depth, cross(edge, p - a) / edge.norm());
  }
  return depth;
}

// The objects that stand on a patch, as point indices, and what is too small to be one.
struct Standing {
  std::vector<Indices> objects;
  std::size_t object_points = 0;
  Indices in_small_clusters;
};

struct Table {
  Patch patch;
  Standing standing;
};

// A cluster seen along the normal of a patch.
struct Footprint {
  Polygon outline;
  double height = 0.0;  // of its highest point
  std::size_t inside = 0,
              well_inside = 0;  // points whose feet lie on the patch, and those not near its border

  double extent() const {
    return outline.empty() ? height : std::max(height, minAreaRectangle(outline).length);
  }
};

// Takes one cloud apart. Indices are those of its points.
class Taker {
 public:
  Taker(const PointCloud& cloud_C, const SceneOptions& options, const StopToken& stop)
      : cloud_C_(cloud_C), options_(options), stop_(stop) {}

  Scene take(const std::optional<Vector3d>& viewpoint_C, const std::optional<Plane>& table) const;

 private:
  double clusterVoxel() const { return options_.cluster_distance_m / 4.0; }
  std::vector<Indices> clustersOf(const Indices& points) const;
  std::optional<Patch> patchOn(const Plane& plane, const PointCloud& coarse, const Voxels& voxels,
                               const Indices& inliers) const;
  Footprint footprintOf(const Patch& patch, const Indices& cluster) const;
  bool isTooLargeForAnObject(const Patch& patch) const;
  bool standsOn(const Patch& patch, const Indices& cluster) const;
  Standing standingOn(const Patch& patch) const;
  Table tableOn(const Patch& patch, const std::optional<Vector3d>& viewpoint_C) const;
  std::optional<Table> findTable(const std::optional<Vector3d>& viewpoint_C) const;
  Table given(const Plane& table) const;
  Scene withTable(Table table) const;
  Scene withoutTable() const;
  Scene whole() const;

  const PointCloud& cloud_C_;
  const SceneOptions& options_;
  const StopToken& stop_;
};

Indices allIndices(std::size_t n) {
  Indices all(n);
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

// Clusters of the points, which ascend as those of each cluster do; the largest first. They are found among
// voxels, so that the time depends on the surface and not on the density.
std::vector<Indices> Taker::clustersOf(const Indices& points) const {
  if (points.empty()) return {};
  const PointCloud some = select(cloud_C_, points);
  const Voxels voxels = sortIntoVoxels(some, clusterVoxel());
  const std::vector<Indices> groups =
      euclideanClusters(meansOf(some, voxels, options_.threads), options_.cluster_distance_m, stop_);
  Indices cluster_of(points.size());
  std::vector<Indices> clusters(groups.size());
  for (std::uint32_t k = 0; k < groups.size(); ++k) {
    std::size_t size = 0;
    for (const std::uint32_t voxel : groups[k]) {
      for (const std::uint32_t i : voxels.points(voxel)) cluster_of[i] = k;
      size += voxels.points(voxel).size();
    }
    clusters[k].reserve(size);
  }
  for (std::size_t i = 0; i < points.size(); ++i) clusters[cluster_of[i]].push_back(points[i]);
  std::ranges::stable_sort(clusters, std::ranges::greater{}, &Indices::size);
  return clusters;
}

Plane facing(const Plane& plane, const Vector3d& viewpoint_C) {
  return heightAbove(plane, viewpoint_C) < 0.0 ? Plane{-plane.normal_C, -plane.offset_m} : plane;
}

// The largest connected part of the plane's points, if it is large enough for a table.
std::optional<Patch> Taker::patchOn(const Plane& plane, const PointCloud& coarse, const Voxels& voxels,
                                    const Indices& inliers) const {
  // Twice the distance between objects: their shadows must not cut the table in two.
  const Indices part =
      euclideanClusters(select(coarse, inliers), 2.0 * options_.cluster_distance_m, stop_).front();
  Patch patch{plane, planeFrame(plane), {}, 0};
  std::vector<Vector2d> feet;
  for (const std::uint32_t i : part) {
    feet.push_back(patch.foot(coarse.point(inliers[i])));
    patch.points += voxels.points(inliers[i]).size();
  }
  patch.outline = convexHull(std::move(feet));
  if (patch.outline.size() < 3) return std::nullopt;
  if (minAreaRectangle(patch.outline).width < options_.min_plane_extent_m) return std::nullopt;
  return patch;
}

Footprint Taker::footprintOf(const Patch& patch, const Indices& cluster) const {
  Footprint footprint;
  std::vector<Vector2d> feet;
  for (const std::uint32_t i : cluster) {
    const Vector3d p_C = cloud_C_.point(i);
    feet.push_back(patch.foot(p_C));
    const double depth = depthInside(patch.outline, feet.back());
    footprint.inside += depth >= -options_.cluster_distance_m;
    footprint.well_inside += depth >= 2.0 * options_.plane_distance_m;
    footprint.height = std::max(footprint.height, heightAbove(patch.plane, p_C));
  }
  footprint.outline = convexHull(std::move(feet));
  return footprint;
}

bool Taker::isTooLargeForAnObject(const Patch& patch) const {
  return minAreaRectangle(patch.outline).length > options_.max_object_extent_m;
}

// Whether a cluster above a patch is something of an object's size that stands on it. A cluster around the
// border of a patch, or covering most of it, is the body of which the patch is a side.
bool Taker::standsOn(const Patch& patch, const Indices& cluster) const {
  constexpr double kMostCovered = 0.6;
  const Footprint footprint = footprintOf(patch, cluster);
  if (footprint.height < options_.plane_distance_m || footprint.extent() > options_.max_object_extent_m)
    return false;
  if (isTooLargeForAnObject(patch)) return 2 * footprint.inside >= cluster.size();
  return 2 * footprint.well_inside >= cluster.size() &&
         signedArea(footprint.outline) <= kMostCovered * signedArea(patch.outline);
}

Standing Taker::standingOn(const Patch& patch) const {
  // Above the plane's noise, so that no more of the objects' feet is lost than must be.
  const double noise = noiseAround(patch.plane, cloud_C_, options_.plane_distance_m);
  const double lowest = std::min(options_.plane_distance_m, 3.0 * noise);
  Indices above;
  for (std::uint32_t i = 0; i < cloud_C_.size(); ++i) {
    if (heightAbove(patch.plane, cloud_C_.point(i)) > lowest) above.push_back(i);
  }
  Standing standing;
  for (Indices& cluster : clustersOf(above)) {
    if (!standsOn(patch, cluster)) continue;
    if (cluster.size() < options_.min_cluster_points) {
      standing.in_small_clusters.insert(standing.in_small_clusters.end(), cluster.begin(), cluster.end());
      continue;
    }
    standing.object_points += cluster.size();
    standing.objects.push_back(std::move(cluster));
  }
  return standing;
}

// The table with its normal to the side of the viewpoint, or of more objects.
Table Taker::tableOn(const Patch& patch, const std::optional<Vector3d>& viewpoint_C) const {
  const auto withNormal = [&](const Plane& plane) {
    Patch turned = patch;
    turned.plane = plane;
    return Table{turned, standingOn(turned)};
  };
  if (viewpoint_C) return withNormal(facing(patch.plane, *viewpoint_C));
  Table up, down;
  parallelFor(2, options_.threads, [&](std::size_t i) {
    if (i == 0)
      up = withNormal(patch.plane);
    else
      down = withNormal({-patch.plane.normal_C, -patch.plane.offset_m});
  });
  return up.standing.object_points >= down.standing.object_points ? up : down;
}

std::size_t countPoints(const Voxels& voxels, const Indices& some) {
  std::size_t count = 0;
  for (const std::uint32_t i : some) count += voxels.points(i).size();
  return count;
}

// Tries the dominant planes in turn: walls and floors may be larger than the table. A patch on which objects
// stand is the table; failing that, one that is too large for an object's side.
std::optional<Table> Taker::findTable(const std::optional<Vector3d>& viewpoint_C) const {
  constexpr int kPlanes = 4;
  // A patch is never wider than the cloud is long.
  if (bounds(cloud_C_).sizes().norm() < options_.min_plane_extent_m) return std::nullopt;
  const Voxels voxels = sortIntoVoxels(cloud_C_, clusterVoxel());
  const PointCloud coarse = meansOf(cloud_C_, voxels, options_.threads);
  std::mt19937_64 random(options_.seed);
  Indices remaining = allIndices(coarse.size());
  std::optional<Table> bare;
  for (int attempt = 0; attempt < kPlanes && remaining.size() >= 3; ++attempt) {
    const Plane plane =
        dominantPlane(coarse, remaining, options_.plane_distance_m, random, options_.threads, stop_);
    const auto rest = std::stable_partition(remaining.begin(), remaining.end(), [&](std::uint32_t i) {
      return std::abs(heightAbove(plane, coarse.point(i))) <= options_.plane_distance_m;
    });
    const double enough = options_.min_plane_fraction * static_cast<double>(countPoints(voxels, remaining));
    const Indices inliers(remaining.begin(), rest);
    remaining.erase(remaining.begin(), rest);
    const auto patch = patchOn(plane, coarse, voxels, inliers);
    if (!patch || static_cast<double>(patch->points) < enough) continue;
    Table table = tableOn(*patch, viewpoint_C);
    if (!table.standing.objects.empty()) return table;
    if (!bare && isTooLargeForAnObject(*patch)) bare = std::move(table);
  }
  return bare;
}

Scene Taker::withTable(Table table) const {
  Scene scene;
  scene.table = table.patch.plane;
  scene.small_cluster_points = table.standing.in_small_clusters.size();
  std::vector<bool> known(cloud_C_.size());
  for (const std::uint32_t i : table.standing.in_small_clusters) known[i] = true;
  for (const Indices& object : table.standing.objects) {
    for (const std::uint32_t i : object) known[i] = true;
  }
  for (std::uint32_t i = 0; i < cloud_C_.size(); ++i) {
    if (known[i]) continue;
    const bool on_table =
        std::abs(heightAbove(*scene.table, cloud_C_.point(i))) <= options_.plane_distance_m &&
        depthInside(table.patch.outline, table.patch.foot(cloud_C_.point(i))) >= -options_.cluster_distance_m;
    ++(on_table ? scene.table_points : scene.background_points);
  }
  scene.objects = std::move(table.standing.objects);
  return scene;
}

Scene Taker::whole() const {
  Scene scene;
  scene.isolated = true;
  scene.objects.push_back(allIndices(cloud_C_.size()));
  return scene;
}

// Without a table the clusters are the objects; one alone, or a cloud too sparse for any, is the whole cloud.
Scene Taker::withoutTable() const {
  // The means of voxels that touch are at most two diagonals apart, so they are in one cluster.
  if (voxelsHangTogether(cloud_C_, clusterVoxel())) return whole();
  Scene scene;
  std::size_t large_enough = 0;
  for (Indices& cluster : clustersOf(allIndices(cloud_C_.size()))) {
    if (cluster.size() < options_.min_cluster_points) {
      scene.small_cluster_points += cluster.size();
      continue;
    }
    ++large_enough;
    if (bounds(select(cloud_C_, cluster)).sizes().maxCoeff() > options_.max_object_extent_m) {
      scene.background_points += cluster.size();
    } else {
      scene.objects.push_back(std::move(cluster));
    }
  }
  return large_enough <= 1 ? whole() : scene;
}

// A table that somebody knows has no end.
Table Taker::given(const Plane& table) const {
  constexpr double kEnd_m = 1e6;
  const Patch patch{table,
                    planeFrame(table),
                    {{-kEnd_m, -kEnd_m}, {kEnd_m, -kEnd_m}, {kEnd_m, kEnd_m}, {-kEnd_m, kEnd_m}},
                    0};
  return {patch, standingOn(patch)};
}

Scene Taker::take(const std::optional<Vector3d>& viewpoint_C, const std::optional<Plane>& known) const {
  if (options_.whole) {
    Scene scene = whole();
    scene.table = known;
    return scene;
  }
  if (known) return withTable(given(*known));
  auto table = findTable(viewpoint_C);
  return table ? withTable(std::move(*table)) : withoutTable();
}

}  // namespace

Scene takeApart(const PointCloud& cloud_C, const SceneOptions& options, const StopToken& stop,
                const std::optional<Vector3d>& viewpoint_C, const std::optional<Plane>& table) {
  options.validate();
  assert(!cloud_C.empty());
  return Taker(cloud_C, options, stop).take(viewpoint_C, table);
}

}  // namespace boxgrasp
