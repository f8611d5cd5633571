// Both sides of a line: their hulls, and the regions of the face where points would make them grow.
#pragma once

#include <utility>
#include <vector>

#include "boxgrasp/decomposition/face_blocks.h"
#include "boxgrasp/geometry/polygon.h"

namespace boxgrasp {

// Points parted by a line; hull vertices take the place of all points where that is enough.
struct Sides {
  std::vector<Vector2d> first, second;
};

// Adds each point to its side.
void part(const std::vector<Vector2d>& points, const Line& line, Sides& sides);

Sides hullsOf(Sides sides);

// Theta of Eq. 1. Pre: the sides are hulls.
double thetaOf(const Sides& hulls, const FaceProjection& face);

bool lexicographic(const Vector2d& a, const Vector2d& b);

// Where a hull's edges go from each vertex.
class EdgeSet {
 public:
  void assign(const Polygon& hull);
  bool has(const Vector2d& from, const Vector2d& to) const;

 private:
  std::vector<std::pair<Vector2d, Vector2d>> edges_;
};

// The inside of a counter-clockwise polygon, where edges that no point is beyond are left out. A polygon
// without area has no inside.
Region insideOf(const Polygon& polygon, const EdgeSet& outermost);

}  // namespace boxgrasp
