// The minimum volume bounding box (paper II, "findBoundingBox").
#pragma once

#include <limits>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/orientation_search.h"
#include "boxgrasp/geometry/oriented_box.h"
#include "boxgrasp/geometry/support_points.h"

namespace boxgrasp {

struct MinVolumeBoxOptions {
  // Search by the plain algorithm: every orientation on a fine grid over all hull points, then refined. Slow;
  // the tests' oracle.
  bool exhaustive = false;
  void validate() const {}  // every value is allowed
};

// The box of least volume around the points, within 0.2 % of the best that the exhaustive search finds. Axes
// are ordered by falling extent. A rigid motion of the cloud moves the box with it, unless two boxes are too
// nearly of one volume to tell which is smaller; the order of the points does not matter. Degenerate clouds
// (one point, a line, a plane) give a box whose flat extents are tolerance::kFlatExtent. Pre: the cloud is
// finite and not empty.
OrientedBox minVolumeBox(const PointCloud& cloud_C, const MinVolumeBoxOptions& options = {},
                         const StopToken& stop = {});

// The search of minVolumeBox step by step, for those who may not need its end.
//
// The box around any of the cloud's points bounds the box around all of them from below. So the search works
// on a few outermost points, measures its best orientations on the whole cloud, takes in the points that
// stick out, and ends when the best box of the whole cloud is no larger than the best one of the few.
// Everything is seen from the canonical frame K, so the result moves with the cloud.
class BoxSearch {
 public:
  // Takes the first step. The cloud is the owner's. Pre: it is finite and not empty.
  explicit BoxSearch(const PointCloud& cloud_C, const StopToken& stop = {});

  // Takes another step; false, and nothing is done, if there is none.
  bool advance(const StopToken& stop = {});

  // What the box's volume will be at least, as far as the search can know: it has no proof that no other
  // orientation is better.
  double volumeAtLeast() const;

  // The best box so far: the one of least volume when all steps are taken.
  OrientedBox box() const;

 private:
  PointCloud seeds() const;
  bool mayGain(double share) const;
  PointCloud measure();
  bool takeIn(const PointCloud& points_C);

  SupportPoints supports_C_;
  Pose X_CK_;
  PointCloud few_K_;
  int passes_;                             // that are left
  int round_ = 0;                          // of the pass
  std::vector<Orientation> orientations_;  // of the few, best first
  Matrix3d axes_C_;                        // the best so far
  double volume_ = std::numeric_limits<double>::infinity();
};

}  // namespace boxgrasp
