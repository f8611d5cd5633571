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

// Every line through a sample point of one long segment and one of another, in a fixed order. Sample points
// lie on the hull, evenly spaced.
std::vector<Line> cutLines(const Polygon& hull, const DecompositionOptions& options);

}  // namespace boxgrasp
