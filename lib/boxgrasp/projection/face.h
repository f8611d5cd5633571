// From where a hand may come to a box: over its faces, and over its edges.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "boxgrasp/decomposition/box_tree.h"

namespace boxgrasp {

// A face of a box. Frame F: origin at the face's centre, z into the box (the approach direction), x
// along the longer edge of the face, y = z cross x: seen from outside, x points right and y down, like the
// columns and rows of its image.
//
// An edge counts as a face too: that of the box around the same points which is turned by 45 degrees about
// the edge. Its image shows what lies on both sides of the edge.
struct Face {
  int node = -1;    // index of the box in BoxTree::nodes
  int number = -1;  // which of the box's faces and edges
  Pose X_CF = Pose::Identity();
  Vector2d size{-1, -1};  // extents along x and y, metres; x >= y
  double depth_m = -1.0;  // extent of the points along z: that of the box, unless it is an edge
};

// Numbers of faces: 2 * axis + (1 on the positive side). Those of edges follow: 6 + 4 * a + 2 * k + s for the
// edges along axis a; with b and c the next two axes in turn, k = 0 is the edge towards +b and +c (s = 1) or
// -b and -c (s = 0), and k = 1 that towards -b and +c (s = 1) or +b and -c (s = 0).
inline constexpr int kFaces = 6;
inline constexpr int kFacesAndEdges = 18;
constexpr bool isEdge(int number) { return number >= kFaces; }

// The side of the box on which it lies, along each axis of the box: -1, +1, or 0 for neither. A face has one
// that is not 0, an edge two.
std::array<int, 3> sidesOf(int number);
std::string faceName(int number);  // "+x", "-y+z"

// The two faces between which the edge lies. Pre: isEdge(number).
std::array<int, 2> facesBeside(int number);

// Pre: number < kFaces.
Face faceOf(const OrientedBox& box, int node, int number);

// The faces of a box in the order of their numbers; its edges after them if they are asked for. `cloud_C` is
// what the tree was made of. Pre: with edges, the node has points.
std::vector<Face> facesOf(const BoxTree& tree, int node, const PointCloud& cloud_C, bool edges);

}  // namespace boxgrasp
