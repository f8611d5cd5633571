// The lines of one face, and Theta of any of them by a look at few points.
#pragma once

#include <optional>
#include <vector>

#include "boxgrasp/decomposition/cut_lines.h"
#include "boxgrasp/decomposition/face_blocks.h"
#include "boxgrasp/decomposition/line_bounds.h"
#include "boxgrasp/decomposition/measured_lines.h"
#include "boxgrasp/decomposition/point_pool.h"
#include "boxgrasp/decomposition/sides.h"

namespace boxgrasp {

class FaceSearch {
 public:
  // The coordinates are those of the face.
  FaceSearch(const FaceProjection& face, const BlockedValues& x, const BlockedValues& y,
             const DecompositionOptions& options);

  const CutLines& cuts() const { return cuts_; }

  // A lower bound of Theta for all lines of the block: see ThetaBounds.
  double bound(const LineBlock& block, int depth) const { return bounds_->of(block, depth); }

  // Theta of a line, or a bound that shows that it cannot win. Remembers points that made a difference, which
  // makes the next lines faster.
  double theta(const Line& line, const MeasuredLines& measured);

 private:
  Polygon outerHull() const;
  void addAll(const PointPool& points, Sides& sides) const;
  double thetaByFewPoints(Sides& sides, const Line& line, const MeasuredLines& measured) const;
  void remember(const Polygon& vertices, const Polygon& known);

  const FaceProjection& face_;
  FaceBlocks blocks_;
  std::optional<HullArcs> arcs_;  // of the hull of all points, if that has an area
  CutLines cuts_;
  PointPool few_;  // known before a line is measured
  std::optional<ThetaBounds> bounds_;
};

}  // namespace boxgrasp
