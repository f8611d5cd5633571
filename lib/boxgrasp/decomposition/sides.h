// Both sides of a line: what is known of their hulls, and the regions of the face where points would make
// them grow.
#pragma once

#include <optional>
#include <vector>

#include "boxgrasp/decomposition/face_projection.h"
#include "boxgrasp/decomposition/half_plane.h"
#include "boxgrasp/decomposition/hull_arcs.h"

namespace boxgrasp {

// The hull of one side: an arc of the hull of all points, and beyond the chord between the arc's ends a cap
// that grows with the points that are added.
class HalfHull {
 public:
  // Of the line's first side or its second. The arcs are the owner's.
  HalfHull(const HullArcs& arcs, const Arc& arc, const Line& line, bool is_first);

  // Adds those of the points that are on this side.
  void add(const std::vector<Vector2d>& points);

  double area() const;

  // The edge between the arc's ends that has the arc on its left; a point where the arc is a vertex.
  const HullEdge& chord() const { return chord_; }

  // The vertices of the cap, without the ends of the chord.
  const Polygon& cap() const { return cap_; }

  // Holds the points of this side and no others.
  HalfPlane side() const;

  // Where a point of this side would not make the hull grow.
  Region inside() const;

 private:
  // The cap with the ends of the chord.
  Polygon closedCap() const;

  Line line_;
  bool is_first_;
  double arc_area_;
  HullEdge chord_;
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
