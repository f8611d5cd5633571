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

// A point of a long segment where lines end.
struct Sample {
  Vector2d point{0, 0};
  std::size_t before = 0;  // the hull vertex where the hull's edge that it lies on begins
};

// The line through two samples; its first side is on the right of the way from one to the other.
struct CutLine {
  Line line;
  std::size_t from = 0, to = 0;  // in CutLines::samples
};

// Every line through a sample of one long segment and one of another, in a fixed order: by `from`, then `to`.
// Samples are evenly spaced on each segment and, like the segments, in the order of the hull.
struct CutLines {
  std::vector<Sample> samples;
  std::vector<CutLine> lines;
  std::size_t per_segment = 1;

  std::size_t segments() const { return samples.size() / per_segment; }
  // The line between two samples. Pre: the segment of `to` is a later one than that of `from`.
  std::size_t index(std::size_t from, std::size_t to) const;
};
CutLines cutLines(const Polygon& hull, const DecompositionOptions& options);

}  // namespace boxgrasp
