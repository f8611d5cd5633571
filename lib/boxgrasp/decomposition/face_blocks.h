// Finds the few points of a face that convex regions leave open, without a look at most of the others.
#pragma once

#include <cstdint>
#include <vector>

#include "boxgrasp/decomposition/face_projection.h"
#include "boxgrasp/decomposition/half_plane.h"
#include "boxgrasp/geometry/block_ranges.h"

namespace boxgrasp {

// One coordinate of a node's points in blocks: runs of points that are neighbours in the node's order. Two of
// these make a face. The coordinates are the owner's.
class BlockedValues {
 public:
  BlockedValues() = default;
  explicit BlockedValues(std::span<const float> coordinates);

  std::span<const float> values() const { return values_; }
  // The values of a block; the last one is filled up with its last value.
  const float* block(std::size_t index) const;
  const BlockRanges& ranges() const { return ranges_; }

 private:
  std::span<const float> values_;
  std::vector<float> last_;  // block
  BlockRanges ranges_;
};

// A point is open when it is in the inside of neither of two regions; one on an edge or nearer to it than the
// rounding error of coordinates is open. The values are the owner's.
class FaceBlocks {
 public:
  FaceBlocks(const BlockedValues& x, const BlockedValues& y);

  // Several rounding errors of a coordinate.
  float margin() const { return margin_; }

  // At most `count` points, spread over the face.
  std::vector<Vector2d> spreadPoints(std::size_t count) const;

  // The farthest point in a direction.
  Vector2d support(float x, float y) const;

  // The points outside of a half plane, and those that may be for rounding.
  std::vector<Vector2d> pointsOutside(const HalfPlane& plane) const;

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
