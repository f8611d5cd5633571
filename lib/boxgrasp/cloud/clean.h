// Validating and cleaning clouds.
#pragma once

#include <cstddef>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

struct ValidationOptions {
  double min_extent_m = 0.001;   // a cloud smaller than this in every direction is refused: 0.1 mm wide objects are a unit mistake
  double max_extent_m = 20.0;    // a cloud larger than this is refused: probably millimetres taken for metres
  void validate() const;
};

// A cloud without its non-finite points, and how many they were.
struct FiniteCloud {
  PointCloud cloud_C;
  std::vector<std::uint32_t> source;  // for each point its index in the given cloud
  std::size_t non_finite = 0;
};

// Throws InputError for a cloud that is empty, has no finite point, or whose extent is suspicious; the message states the
// extent, the bound and the remedy (`--scale 0.001`). One point, or points on one spot, are refused as such.
FiniteCloud validated(const PointCloud& cloud_C, const ValidationOptions& options = {});

struct CleanOptions {
  double voxel_m = 0.0015;            // density is evened to one point a voxel of this edge; 0: not evened
  int outlier_neighbours = 8;         // an outlier's mean distance to this many neighbours ... ; 0: outliers are kept
  double outlier_deviations = 4.0;    // ... exceeds the cloud's mean by this many standard deviations (PCL StatisticalOutlierRemoval)
  std::size_t max_points = 60'000;    // a cloud with more occupied voxels than this gets larger voxels, until it fits
  void validate() const;
};

struct CleanCloud {
  PointCloud cloud_C;
  std::size_t duplicates = 0;         // points at exactly the place of another
  std::size_t merged = 0;             // further points that shared a voxel
  std::size_t outliers = 0;
  double voxel_m = 0.0;               // the edge that was used; 0: none
  double spacing_m = -1.0;            // median distance from a point to its nearest neighbour, after cleaning
};

// Evens the density and drops outliers. The voxels lie in the canonical frame of the cloud and a voxel's point is the mean of its
// points, so a rigid motion of the cloud moves the result with it and the order of the points does not matter; the result is
// ordered by voxel. Pre: finite and not empty.
CleanCloud clean(const PointCloud& cloud_C, const CleanOptions& options = {}, const StopToken& stop = {});

}  // namespace boxgrasp
