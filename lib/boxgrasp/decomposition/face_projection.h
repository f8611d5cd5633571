// A node's points projected along one axis of its box.
#pragma once

#include <span>

#include "boxgrasp/decomposition/box_tree.h"
#include "boxgrasp/geometry/polygon.h"

namespace boxgrasp {

// Coordinates on the face, metres, relative to the box's centre: x along box axis (axis + 1) % 3, y along
// (axis + 2) % 3. The arrays are the owner's.
struct FaceProjection {
  int axis = -1;
  double area = -1.0;           // F of Eq. 1: of the whole face
  std::span<const float> x, y;  // one a point of the node, in its order

  std::size_t size() const { return x.size(); }
  Vector2d point(std::size_t i) const { return {x[i], y[i]}; }
};

FaceProjection projectionAlong(int axis, const OrientedBox& box, const PointCloud& cloud_B);

// A line on a face. Points are judged in single precision everywhere, so that all agree on the sides of each.
struct Line {
  float normal_x = 0.0f, normal_y = 0.0f;  // unit
  float offset = 0.0f;

  bool isFirst(float x, float y) const { return normal_x * x + normal_y * y <= offset; }
};

// The plane through the line along the axis of projection.
Cut cutAlong(const Line& line, int axis, const OrientedBox& box);

// How many points are on the line's first side.
std::size_t countFirst(const FaceProjection& face, const Line& line);

// The least number of points that each side of a cut must have.
std::size_t leastPoints(std::size_t points, double min_point_fraction);

}  // namespace boxgrasp
