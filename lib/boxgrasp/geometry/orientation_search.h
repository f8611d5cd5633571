// Searches for the orientation in which the box around a few points is smallest. Part of minVolumeBox.
#pragma once

#include <vector>

#include "boxgrasp/geometry/point_cloud.h"

namespace boxgrasp {

// A box's orientation in the frame of the points, and the volume of the box around them (flat extents raised
// to tolerance::kFlatExtent). In single precision: good enough to compare orientations, not for the box
// itself.
struct Orientation {
  Eigen::Quaternionf rotation = Eigen::Quaternionf::Identity();
  float volume = -1.0f;
};

// Some good orientations that differ from each other, the best first: a lattice over all orientations of a
// box, then descents of so many trials from its most promising places that are not neighbours. The order of
// the points does not matter. Pre: not empty, trials from 1 to 100.
std::vector<Orientation> searchOrientations(const PointCloud& points, int trials);

// Brings orientations that were good for some of the points up to date with all of them; best first.
void updateOrientations(const PointCloud& points, std::vector<Orientation>& orientations);

// The axes of the smallest box around the points that has an edge along the unit vector `edge`, the third
// column: exact, by the smallest rectangle around the projection along it. Pre: not empty.
Matrix3d smallestBoxAxes(const PointCloud& points, const Vector3d& edge);

}  // namespace boxgrasp
