// Both sides of a line: what is known of their hulls, and the regions of the face where points would make
// them grow.
#pragma once

#include <optional>
#include <vector>

#include "boxgrasp/decomposition/face_blocks.h"
#include "boxgrasp/decomposition/hull_arcs.h"

namespace boxgrasp {

bool lexicographic(const Vector2d& a, const Vector2d& b);

// The inside of a counter-clockwise polygon. One without area has no inside.
Region insideOf(const Polygon& polygon);

// The hull of one side: an arc of the hull of all points, and beyond the chord between the arc's ends a cap
// that points are added to.
class HalfHull {
 public:
  // `side`: the half plane whose points are on this side. The arcs are the owner's.
  HalfHull(const HullArcs& arcs, const Arc& arc, const HalfPlane& side);

  // Adds those of the points of this side that are beyond the chord. Pre: in lexicographic order.
  void add(const std::vector<Vector2d>& points);

  double area() const { return arc_area_ + signedArea(cap_); }

  // Where a point of this side would not make the hull grow.
  Region inside() const;

 private:
  bool isBeyondChord(const Vector2d& p) const { return is_vertex_ || cross(to_ - from_, p - from_) < 0.0; }

  HalfPlane side_;
  double arc_area_;
  Vector2d from_, to_;  // the chord, with the arc on its left
  bool is_vertex_;      // the arc is a vertex and has no chord
  Polygon cap_;
};

class Sides {
 public:
  // The sides of a line with the arcs of the hull alone; nothing where the line does not part the hull's
  // vertices in two runs: rounding can do that to a line along an edge.
  static std::optional<Sides> of(const HullArcs& arcs, const Line& line);

  // Adds each point to its side.
  void add(std::vector<Vector2d> points);

  double area() const { return first_.area() + second_.area(); }
  Region firstInside() const { return first_.inside(); }
  Region secondInside() const { return second_.inside(); }

 private:
  Sides(const Line& line, HalfHull first, HalfHull second)
      : line_(line), first_(std::move(first)), second_(std::move(second)) {}

  Line line_;
  HalfHull first_, second_;
};

}  // namespace boxgrasp
