// Finds the few points of a face that convex regions leave open, without a look at most of the others.
#pragma once

#include <cstdint>
#include <vector>

#include "boxgrasp/decomposition/face_projection.h"
#include "boxgrasp/geometry/block_ranges.h"

namespace boxgrasp {

// The points where normal.p <= offset.
struct HalfPlane {
  float normal_x = 0.0f, normal_y = 0.0f;
  float offset = 0.0f;
};

// What all of its half planes have in common.
using Region = std::vector<HalfPlane>;

// One coordinate of a node's points, padded by the last to whole blocks: runs of points that are neighbours
// in the node's order. Two of these make a face.
struct BlockedValues {
  BlockedValues() = default;
  explicit BlockedValues(std::span<const float> coordinates);

  std::vector<float> values;
  BlockRanges ranges;
};

// A point is open when it is in the inside of neither of two regions; one on an edge or nearer to it than the
// rounding error of coordinates is open. The values are the owner's.
class FaceBlocks {
 public:
  FaceBlocks(const BlockedValues& x, const BlockedValues& y);

  // At most `count` points, spread over the face.
  std::vector<Vector2d> spreadPoints(std::size_t count) const;

  // The farthest point in a direction.
  Vector2d support(float x, float y) const;

  // Indices of the blocks that may hold an open point.
  std::vector<std::uint32_t> openBlocks(const Region& a, const Region& b) const;

  // Appends the open points of the given blocks.
  void appendOpenPoints(const std::vector<std::uint32_t>& blocks, const Region& a, const Region& b,
                        std::vector<Vector2d>& points) const;

  // Appends, for each of the blocks, its point nearest to the line on either side.
  void appendNearest(const std::vector<std::uint32_t>& blocks, const Line& line,
                     std::vector<Vector2d>& points) const;

 private:
  // How far the blocks' bounding rectangles reach out of a region.
  std::vector<float> reachOut(const Region& region) const;

  const BlockedValues &x_, &y_;
  float margin_ = 0.0f;
};

}  // namespace boxgrasp
