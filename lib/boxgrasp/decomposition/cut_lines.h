// The lines that the hull-based split tries on a face (paper II.A).
#pragma once

#include <vector>

#include "boxgrasp/decomposition/decompose.h"
#include "boxgrasp/decomposition/face_projection.h"

namespace boxgrasp {

// Runs of neighbouring hull edges that turn by less than merge_angle_rad altogether and are longer than
// segment_fraction of the perimeter: "segments of the hull that exceed a given threshold in length". A run is
// the polyline of its vertices.
std::vector<std::vector<Vector2d>> longSegments(const Polygon& hull, const DecompositionOptions& options);

// The lines from one sample point, the apex, to those of all later segments.
struct CutFan {
  Vector2d apex;
  std::vector<Line> lines;
};

// Every line through a sample point of one long segment and one of another, in a fixed order. Sample points
// lie on the hull, evenly spaced.
std::vector<CutFan> cutFans(const Polygon& hull, const DecompositionOptions& options);
std::vector<Line> cutLines(const std::vector<CutFan>& fans);

}  // namespace boxgrasp
