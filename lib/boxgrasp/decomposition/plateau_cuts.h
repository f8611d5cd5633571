// Cut planes from the middle of plateaus of Theta.
#pragma once

#include <vector>

#include "boxgrasp/decomposition/box_tree.h"

namespace boxgrasp {

// A plane along one face's direction of projection.
struct PlateauCut {
  Vector3d normal_C;
  double offset_m = 0.0;
  Vector3d along_C;     // the direction of projection
  double theta = -1.0;  // the least Theta (Eq. 1) on the plateau
};

// Tries every line of a regular grid of angles and offsets on each of the box's three faces, not only those
// between long segments of the hull, which noise breaks; a line on the grid moves little when the points move
// little. Lines around a minimum of Theta (within `kPlateau` of it) make one cut: their mean, weighted by how
// far below the plateau's edge they lie. Gives the cuts of the `most` lowest minima that are not neighbours,
// lowest first. Each side of a line has at least `least` points.
std::vector<PlateauCut> plateauCuts(const PointCloud& points_C, const OrientedBox& box, std::size_t least,
                                    std::size_t most);

}  // namespace boxgrasp
