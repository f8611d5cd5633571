// Validating and cleaning clouds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

struct ValidationOptions {
  // A cloud smaller than this in every direction is refused: nothing so small can be grasped, its unit is a
  // mistake.
  double min_extent_m = 0.001;
  // A cloud larger than this in any direction is refused: probably millimetres taken for metres.
  double max_extent_m = 20.0;
  void validate() const;
};

// A cloud without its non-finite points, and how many they were.
struct FiniteCloud {
  PointCloud cloud_C;
  std::size_t non_finite = 0;
};

// Throws InputError for a cloud that is empty, has no finite point, whose extent is suspicious, or that lies
// so far from the origin that floats no longer resolve its shape; the message states the value, the bound and
// the remedy (`--scale 0.001`). One point, or points on one spot, are refused as such.
FiniteCloud validated(PointCloud cloud_C, const ValidationOptions& options = {});

struct CleanOptions {
  // Density is evened to one point a voxel of this edge, about a fingertip's accuracy; 0: it is not evened.
  double voxel_m = 0.0015;
  // An outlier's mean distance to this many neighbours ... More find small clumps of outliers too; 0:
  // outliers are kept.
  int outlier_neighbours = 8;
  // ... exceeds the cloud's mean by this many standard deviations (PCL StatisticalOutlierRemoval). Fewer cut
  // into thin parts.
  double outlier_deviations = 4.0;
  // A cloud with more occupied voxels than this gets larger voxels, until it fits: bounds the planner's time.
  // Does not apply to voxel_m = 0.
  std::size_t max_points = 60'000;
  int threads = 1;  // 0 = all cores; the result does not depend on it
  void validate() const;
};

struct CleanCloud {
  PointCloud cloud_C;
  std::size_t duplicates = 0;  // points at exactly the place of another
  std::size_t merged = 0;      // further points that shared a voxel
  std::size_t outliers = 0;    // points of the evened cloud that were dropped
  double voxel_m = 0.0;        // the edge that was used; 0: none
  double spacing_m =
      -1.0;  // median distance from a point to its nearest neighbour, after cleaning; -1: one point
};

// Evens the density and drops outliers. The voxels lie in the canonical frame of the cloud and a voxel's
// point is the mean of its points, summed exactly: the order of the points does not matter at all, and a
// rigid motion of the cloud moves the result with it, but for the few points that lie within rounding of a
// voxel's border. The result is ordered by voxel. Pre: finite and not empty.
CleanCloud clean(const PointCloud& cloud_C, const CleanOptions& options = {}, const StopToken& stop = {});

}  // namespace boxgrasp
