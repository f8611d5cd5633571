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

// A point of a long segment where lines end. All of the hull is on the left of `edge`, the unit direction of
// the hull edge that it lies on.
struct Sample {
  Vector2d point{0, 0};
  Vector2d edge{1, 0};
};

// The line through two samples; its first side is on the right of the way from one to the other.
struct CutLine {
  Line line;
  std::size_t from = 0, to = 0;  // in CutLines::samples
};

// Every line through a sample of one long segment and one of another, in a fixed order: by `from`, then `to`.
// Samples are evenly spaced on each segment.
struct CutLines {
  std::vector<Sample> samples;
  std::vector<CutLine> lines;
};
CutLines cutLines(const Polygon& hull, const DecompositionOptions& options);

}  // namespace boxgrasp
