// Polygons in the plane: convex hulls, areas, centroids, half-plane clipping, minimum-area rectangles.
#pragma once

#include <vector>

#include "boxgrasp/geometry/pose.h"

namespace boxgrasp {

// Vertices in counter-clockwise order, none repeated at the end.
using Polygon = std::vector<Vector2d>;

inline double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// The convex hull by the monotone chain (paper II.A, ref. [14]); counter-clockwise, collinear points (to the
// rounding error of the largest coordinate) left out. Fewer than three vertices when the points are
// coincident or collinear. O(n log n).
Polygon convexHull(std::vector<Vector2d> points);

// The vertices of the hull of a, b and the points beyond the way from a to b (on its right), from a to b in
// counter-clockwise order and without these two (quickhull). One that is collinear with its neighbours may be
// among them. Pre: a != b. O(n log n) for points in no particular order.
Polygon hullBeyond(const Vector2d& a, const Vector2d& b, std::vector<Vector2d> points);

// Positive for counter-clockwise order; 0 for fewer than three vertices.
double signedArea(const Polygon& polygon);

// The area centroid; for zero area the mean of the vertices. Pre: not empty.
Vector2d centroid(const Polygon& polygon);

// The part of a convex polygon where normal.(x - point) >= 0 (Sutherland-Hodgman). May be empty.
Polygon clip(const Polygon& convex, const Vector2d& point, const Vector2d& normal);

// Whether p is in a counter-clockwise convex polygon, its edge included. Fewer than three vertices contain
// nothing.
bool containsPoint(const Polygon& convex, const Vector2d& p);

// The rectangle of least area around a convex hull, `axis` along a hull edge (rotating calipers, O(n)). A
// point or a segment gives a rectangle of width 0. Pre: not empty.
struct Rectangle {
  Vector2d center{0, 0};
  Vector2d axis{1, 0};   // unit vector along `length`
  double length = -1.0;  // along axis
  double width = -1.0;   // perpendicular to it
  double area() const { return length * width; }
};
Rectangle minAreaRectangle(const Polygon& hull);

}  // namespace boxgrasp
