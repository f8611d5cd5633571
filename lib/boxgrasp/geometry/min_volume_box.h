// The minimum volume bounding box (paper II, "findBoundingBox").
#pragma once

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/geometry/oriented_box.h"

namespace boxgrasp {

struct MinVolumeBoxOptions {
  // Search by the plain algorithm: every orientation on a fine grid over all hull points, then refined. Slow;
  // the tests' oracle.
  bool exhaustive = false;
  void validate() const {}  // every value is allowed
};

// The box of least volume around the points, within 0.2 % of the best that the exhaustive search finds. Axes
// are ordered by falling extent. A rigid motion of the cloud moves the box with it; the order of the points
// does not matter. Degenerate clouds (one point, a line, a plane) give a box whose flat extents are
// tolerance::kFlatExtent. Pre: the cloud is finite and not empty.
OrientedBox minVolumeBox(const PointCloud& cloud_C, const MinVolumeBoxOptions& options = {},
                         const StopToken& stop = {});

}  // namespace boxgrasp
