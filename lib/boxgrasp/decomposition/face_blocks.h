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

// Points of a face in whole blocks, as many as there are so far.
class PointPool {
 public:
  void add(const Vector2d& p);

  std::size_t blocks() const;
  // The coordinates of a block; the last one is filled up with its first point.
  const float* x(std::size_t block) const;
  const float* y(std::size_t block) const;

 private:
  std::size_t size_ = 0;
  std::vector<float> x_, y_;  // whole blocks
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

  // Appends the open points of a pool.
  void appendOpenPoints(const PointPool& pool, const Region& a, const Region& b,
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
