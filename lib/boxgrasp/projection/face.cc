#include "boxgrasp/projection/face.h"

#include <cassert>
#include <numbers>

namespace boxgrasp {
namespace {

// The box around the node's points that is turned by 45 degrees about one of its axes: +b of it points
// between +b and +c, +c of it between -b and +c.
OrientedBox turnedBox(const BoxNode& node, const PointCloud& cloud_C, int axis) {
  const Eigen::AngleAxisd turn(0.25 * std::numbers::pi, Vector3d::Unit(axis));
  return boxAround(select(cloud_C, node.points), node.box.X_CB.linear() * turn.toRotationMatrix());
}

}  // namespace

std::array<int, 3> sidesOf(int number) {
  assert(number >= 0 && number < kFacesAndEdges);
  std::array<int, 3> sides{0, 0, 0};
  const int sign = number % 2 ? 1 : -1;
  if (!isEdge(number)) {
    sides[static_cast<std::size_t>(number / 2)] = sign;
    return sides;
  }
  const auto along = static_cast<std::size_t>((number - kFaces) / 4);
  const bool across = (number - kFaces) % 4 >= 2;
  sides[(along + 1) % 3] = across ? -sign : sign;
  sides[(along + 2) % 3] = sign;
  return sides;
}

std::string faceName(int number) {
  std::string name;
  const std::array<int, 3> sides = sidesOf(number);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (sides[axis] != 0) name += {sides[axis] > 0 ? '+' : '-', "xyz"[axis]};
  }
  return name;
}

std::array<int, 2> facesBeside(int number) {
  assert(isEdge(number));
  std::array<int, 2> faces{};
  const std::array<int, 3> sides = sidesOf(number);
  for (int axis = 0, found = 0; axis < 3; ++axis) {
    const int side = sides[static_cast<std::size_t>(axis)];
    if (side != 0) faces[static_cast<std::size_t>(found++)] = 2 * axis + (side > 0);
  }
  return faces;
}

Face faceOf(const OrientedBox& box, int node, int number) {
  assert(number >= 0 && !isEdge(number));
  const int axis = number / 2, sign = number % 2 ? 1 : -1;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const int longer = box.extents[u] >= box.extents[v] ? u : v, shorter = u + v - longer;
  const Vector3d outward_C = sign * box.X_CB.linear().col(axis);
  Matrix3d R_CF;
  R_CF.col(0) = box.X_CB.linear().col(longer);
  R_CF.col(2) = -outward_C;
  R_CF.col(1) = R_CF.col(2).cross(R_CF.col(0));
  Face face;
  face.node = node;
  face.number = number;
  face.X_CF = makePose(R_CF, box.X_CB.translation() + 0.5 * box.extents[axis] * outward_C);
  face.size = {box.extents[longer], box.extents[shorter]};
  face.depth_m = box.extents[axis];
  return face;
}

std::vector<Face> facesOf(const BoxTree& tree, int node, const PointCloud& cloud_C, bool edges) {
  const BoxNode& its = tree.nodes[node];
  std::vector<Face> faces;
  for (int number = 0; number < kFaces; ++number) faces.push_back(faceOf(its.box, node, number));
  for (int along = 0; edges && along < 3; ++along) {
    const OrientedBox turned = turnedBox(its, cloud_C, along);
    for (const int axis : {(along + 1) % 3, (along + 2) % 3}) {
      for (const int positive : {0, 1}) {
        faces.push_back(faceOf(turned, node, 2 * axis + positive));
        faces.back().number = static_cast<int>(faces.size()) - 1;
      }
    }
  }
  return faces;
}

}  // namespace boxgrasp
