// Both sides of a line: what is known of their hulls, and the regions of the face where points would make
// them grow.
#pragma once

#include <optional>
#include <vector>

#include "boxgrasp/decomposition/face_blocks.h"
#include "boxgrasp/decomposition/hull_arcs.h"

namespace boxgrasp {

// What is on the left of the way from one point to another.
HalfPlane leftOf(const Vector2d& from, const Vector2d& to);

// The hull of one side: an arc of the hull of all points, and beyond the chord between the arc's ends a cap
// that grows with the points that are added.
class HalfHull {
 public:
  // Of the line's first side or its second. The arcs are the owner's.
  HalfHull(const HullArcs& arcs, const Arc& arc, const Line& line, bool is_first);

  // Adds those of the points that are on this side.
  void add(const std::vector<Vector2d>& points);

  double area() const;

  // The vertices of the cap, without the ends of the chord.
  const Polygon& cap() const { return cap_; }

  // Where a point of this side would not make the hull grow.
  Region inside() const;

 private:
  // The cap with the ends of the chord.
  Polygon closedCap() const;

  // The half plane of this side, the line included.
  HalfPlane halfPlane() const;

  Line line_;
  bool is_first_;
  double arc_area_;
  Vector2d from_, to_;  // the chord, with the arc on its left; both are the same where the arc is a vertex
  Polygon cap_;
};

class Sides {
 public:
  // The sides of a line with the arcs of the hull alone; nothing where the line does not part the hull's
  // vertices in two runs: rounding can do that to a line along an edge.
  static std::optional<Sides> of(const HullArcs& arcs, const Line& line);

  // Adds each point to its side's hull.
  void add(const std::vector<Vector2d>& points);

  double area() const { return first_.area() + second_.area(); }
  const HalfHull& first() const { return first_; }
  const HalfHull& second() const { return second_; }

 private:
  Sides(HalfHull first, HalfHull second) : first_(std::move(first)), second_(std::move(second)) {}

  HalfHull first_, second_;
};

}  // namespace boxgrasp
