// Lower bounds of Theta (Eq. 1) for many cut lines of a face at once.
#pragma once

#include <array>
#include <vector>

#include "boxgrasp/decomposition/cut_lines.h"
#include "boxgrasp/decomposition/hull_arcs.h"
#include "boxgrasp/decomposition/point_pool.h"

namespace boxgrasp {

// The lines from each sample of a run on one segment to each of a run on a later one; both ends belong to a
// run.
struct LineBlock {
  std::size_t first_from = 0, last_from = 0, first_to = 0, last_to = 0;  // in CutLines::samples

  std::size_t size() const { return (last_from - first_from + 1) * (last_to - first_to + 1); }
};

// One block for each pair of segments.
std::vector<LineBlock> blocksOf(const CutLines& cuts);

// The two halves of a block of more than one line.
std::array<LineBlock, 2> halvesOf(const LineBlock& block);

// Of the points in the inside of a face that bounds are taken from.
inline constexpr std::size_t kMostBoundPoints = 512;

// Bounds from the hull of the face and a few points in its inside. Along the hull the sides of a block's
// lines contain each other: the smallest first side is that of the line from the last sample to the first,
// the smallest second side that of the line from the first to the last. The hull of some of the points of a
// side is at most that of the side, so the areas of these two bound Theta of all lines in the block.
class ThetaBounds {
 public:
  // The arcs and the lines are the owner's; the points are some of the face's. Pre: at most kMostBoundPoints
  // points.
  ThetaBounds(const HullArcs& arcs, const CutLines& cuts, double face_area,
              const std::vector<Vector2d>& points);

  // Of `depth` d the hulls on both sides have up to 2^d - 1 points more than the hull of the face.
  double of(const LineBlock& block, int depth) const;

 private:
  // Of the first side of the line from one sample to another; the second is the first of the way back.
  double sideArea(std::size_t from, std::size_t to, int depth) const;

  const HullArcs& arcs_;
  const CutLines& cuts_;
  double face_area_;
  PointPool points_;
  double reach_ = 0.0;  // the largest coordinate
};

}  // namespace boxgrasp
