// The two rules that find a node's best split. Both give nothing where no line leaves enough points on both
// sides.
#pragma once

#include <array>
#include <optional>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/decomposition/decompose.h"
#include "boxgrasp/decomposition/face_projection.h"

namespace boxgrasp {

using FaceProjections = std::array<FaceProjection, 3>;  // along the three box axes: the non-opposite faces

struct BestLine {
  double theta = -1.0;
  int face = -1;
  Line line;
};

// The line with the least Theta (Eq. 1) over the three faces (paper II.A); of equals the first.
// options.exhaustive tries every line on all points; else lines are bounded from below on few points and only
// the most promising are tried on all: the same line.
std::optional<BestLine> bestHullLine(const FaceProjections& faces, const DecompositionOptions& options,
                                     const StopToken& stop);

// The line parallel to an edge with the least summed area of bounding rectangles (Alg. II.2), as a share of
// the face.
std::optional<BestLine> bestBoundLine(const FaceProjections& faces, const DecompositionOptions& options);

// Theta of one line by Eq. 1 on all points; nullopt when a side has fewer than `least` points. The plain way.
std::optional<double> plainTheta(const FaceProjection& face, const Line& line, std::size_t least);

}  // namespace boxgrasp
