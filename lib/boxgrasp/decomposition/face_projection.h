// A node's points projected along one axis of its box.
#pragma once

#include <vector>

#include "boxgrasp/decomposition/box_tree.h"
#include "boxgrasp/geometry/polygon.h"

namespace boxgrasp {

// Coordinates on the face, metres, relative to the box's centre: x along box axis (axis + 1) % 3, y along
// (axis + 2) % 3.
struct FaceProjection {
  int axis = -1;
  double area = -1.0;  // F of Eq. 1: of the whole face
  Vector3d origin_C, x_C, y_C;
  std::vector<double> x, y;  // one a point of the node, in its order

  std::size_t size() const { return x.size(); }
  Vector2d point(std::size_t i) const { return {x[i], y[i]}; }
};

FaceProjection projectNode(const PointCloud& cloud_C, const BoxNode& node, int axis);

// A line on the face: points with normal.p <= offset belong to the first side.
struct Line {
  Vector2d normal{0, 0};  // unit
  double offset = 0.0;
};

// The plane through the line along the axis of projection.
Cut cutAlong(const FaceProjection& face, const Line& line);

// A split of a node: the best line on one of its faces and its Theta.
struct Split {
  double theta = -1.0;
  Cut cut;
  std::vector<std::uint32_t> first, second;  // the node's points on either side, in the node's order
};

// Parts the node's points by a line on the face.
Split splitBy(const FaceProjection& face, const Line& line, double theta,
              const std::vector<std::uint32_t>& points);

// The least number of points that each side of a cut must have.
std::size_t leastPoints(std::size_t points, double min_point_fraction);

}  // namespace boxgrasp
