// The two rules that find a node's best split. Both give nothing where no line will do.
#pragma once

#include <array>
#include <optional>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/decomposition/cut_lines.h"

namespace boxgrasp {

using FaceProjections = std::array<FaceProjection,
                                   3>;  // along the three box axes: the non-opposite faces

struct BestLine {
  double theta = -1.0;
  int face = -1;
  Line line;
};

// The line with the least Theta (Eq. 1) over the three faces (paper II.A) among those with a Theta below
// gain_t and enough points on both sides. Of those within tolerance::kEqualTheta of the least, the first is
// taken. options.exhaustive tries every line on all points; else lines are bounded from below on few points
// and the promising ones alone are tried on all: the same line.
std::optional<BestLine> bestHullLine(const FaceProjections& faces, const DecompositionOptions& options,
                                     const StopToken& stop);

// The line parallel to an edge with the least summed area of bounding rectangles (Alg. II.2), as a share of
// the face. Of equals the first.
std::optional<BestLine> bestBoundLine(const FaceProjections& faces, const DecompositionOptions& options);

// Theta of one line (Eq. 1), by the hulls of all points.
double plainTheta(const FaceProjection& face, const Line& line);

}  // namespace boxgrasp
