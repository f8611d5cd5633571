// The tree of boxes that approximates a cloud (paper II, Fig. 2).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "boxgrasp/geometry/oriented_box.h"

namespace boxgrasp {

// The plane that parts a box's points: p goes to the first child where normal_C.p <= offset_m.
struct Cut {
  Vector3d normal_C = Vector3d::Zero();
  double offset_m = 0.0;
  int axis = -1;  // the box axis along which the points were projected: 0, 1 or 2
};

struct BoxNode {
  OrientedBox box;
  int parent = -1;              // index in BoxTree::nodes; -1 for the root
  int first = -1, second = -1;  // children; -1 for a leaf
  int depth = 0;
  double theta = -1.0;        // the best split's Theta* (Eq. 1); -1 where none is below t
  std::optional<Cut> cut;     // the best split found, made or not
  double volume_gain = -1.0;  // (V(p) + V(q)) / V(box) of that split, for a leaf at least; -1: none was tried
  std::string stop_reason;    // why a leaf was not split; empty for an inner node
  std::vector<std::uint32_t> points;  // indices into the decomposed cloud, ascending

  bool leaf() const { return first < 0; }
};

// nodes[0] is the root; a parent stands before its children.
struct BoxTree {
  std::vector<BoxNode> nodes;

  std::vector<int> leaves() const;  // indices, ascending
  double leafVolume() const;        // the sum of the leaves' volumes, m^3
};

}  // namespace boxgrasp
