// What the points of a leaf box look like: a box, a cylinder or a sphere.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "boxgrasp/decomposition/box_tree.h"

namespace boxgrasp {

enum class ShapeKind { box, cylinder, sphere };
std::string_view describe(ShapeKind kind);

struct ShapeOptions {
  // Grasps on a round face are put where the fitted circle says rather than the chords of its outline: the
  // fingers against each other through the axis, with its normals. A cup gets more clear grasps, a can
  // fewer; of the best ones as many hold as without. false: shapes are told, and not used.
  bool snap = false;
  // A leaf with fewer surface cells that hold a point is a box: too little is known of it.
  int min_cells = 60;
  // Round only where the points lie so much nearer to the round surface than to the box's: the share of the
  // one residual in the other. Smaller: more doubtful shapes stay boxes.
  double max_residual_share = 0.6;
  // Round only where the surface goes so far around its axis or centre: small pieces of large circles are as
  // good as flat.
  double min_arc_rad = 2.1;
  void validate() const;
};

// One node's shape. Lengths in metres.
struct BoxShape {
  ShapeKind kind = ShapeKind::box;
  Vector3d center_C = Vector3d::Zero();  // of a sphere; of a cylinder the middle of its axis
  Vector3d axis_C = Vector3d::Zero();    // of a cylinder, unit; an axis of the box
  double radius_m = 0.0;                 // of cylinder and sphere
  // Of the points to the surfaces of box, cylinder and sphere, root mean square over the nearest 80 %;
  // infinity where there is no such surface.
  std::array<double, 3> residual_m{std::numeric_limits<double>::infinity(),
                                   std::numeric_limits<double>::infinity(),
                                   std::numeric_limits<double>::infinity()};
};

// Tells what the points inside the box are. Their outermost in each of 600 directions from its centre count,
// all alike: so how densely a side was sampled, and what is inside, do not matter. Cylinders (along each axis
// of the box) and spheres are fitted by the sum of squared distances with Tukey's weights, so that strays do
// not count. The ends of a cylinder are those of the box. Throws InputError for bad options.
BoxShape shapeOf(const PointCloud& cloud_C, const std::vector<std::uint32_t>& points, const OrientedBox& box,
                 const ShapeOptions& options = {});

// Of every node of the tree; inner nodes count as boxes.
std::vector<BoxShape> shapesOf(const PointCloud& cloud_C, const BoxTree& tree,
                               const ShapeOptions& options = {});

}  // namespace boxgrasp
