// The lines of one face, and Theta of any of them by a look at few points.
#pragma once

#include <vector>

#include "boxgrasp/decomposition/cut_lines.h"
#include "boxgrasp/decomposition/measured_lines.h"
#include "boxgrasp/decomposition/sides.h"

namespace boxgrasp {

// Keeps a lower bound of Theta for each line of the face, which bound() raises and take() replaces by Theta.
class FaceSearch {
 public:
  FaceSearch(const FaceProjection& face, const DecompositionOptions& options);

  // Raises the bounds of the lines that may win, by about `spread` points.
  void bound(std::size_t spread, const MeasuredLines& measured);

  const std::vector<double>& bounds() const { return bounds_; }

  // Of those lines that may win, how many samples they start from.
  std::size_t fans(const MeasuredLines& measured) const;

  const Line& line(std::size_t index) const { return cuts_.lines[index].line; }

  // Marks a line as done and gives its Theta, or a bound that shows that it cannot win.
  double take(std::size_t index, const MeasuredLines& measured);

 private:
  std::vector<Vector2d> withSpread(std::vector<Vector2d> points, std::size_t spread) const;
  double theta(const Line& line, const MeasuredLines& measured) const;
  Polygon outerHull() const;
  std::pair<Region, Region> regionsOf(const Sides& hulls, const Line& line) const;
  std::vector<std::uint32_t> openBlocks(const Sides& hulls, const Line& line) const;

  const FaceProjection& face_;
  FaceBlocks blocks_;
  Polygon hull_;
  EdgeSet outermost_;  // the edges of the hull of all points
  CutLines cuts_;
  std::vector<Vector2d> few_;  // known before a line is measured
  std::vector<double> bounds_;
};

}  // namespace boxgrasp
