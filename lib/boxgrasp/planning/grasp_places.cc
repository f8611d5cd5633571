#include "boxgrasp/planning/grasp_places.h"

#include <algorithm>

namespace boxgrasp {
namespace {

double unitOf(const BoxTree& tree) { return tree.nodes.front().box.extents.maxCoeff(); }

// The middle of a cell, in units of the cube.
Vector3d middleOf(std::size_t cell) {
  constexpr std::size_t side = Constellation::kSide;
  const Vector3d steps(static_cast<double>(cell % side), static_cast<double>(cell / side % side),
                       static_cast<double>(cell / (side * side)));
  return (steps.array() + 0.5) / static_cast<double>(side) - 0.5;
}

}  // namespace

Constellation constellationOf(const BoxTree& tree) {
  Constellation constellation{unitOf(tree), {}};
  const Pose& X_CB = tree.nodes.front().box.X_CB;
  const double cell_m = constellation.unit_m / Constellation::kSide;
  std::vector<OrientedBox> leaves;
  for (const int leaf : tree.leaves()) {
    OrientedBox& box = leaves.emplace_back(tree.nodes[static_cast<std::size_t>(leaf)].box);
    box.extents = box.extents.cwiseMax(cell_m);  // else a thin one may pass between the middles of all cells
  }
  for (std::size_t cell = 0; cell < constellation.cells.size(); ++cell) {
    const Vector3d p_C = X_CB * (constellation.unit_m * middleOf(cell));
    if (std::ranges::any_of(leaves, [&](const OrientedBox& box) { return box.contains(p_C); }))
      constellation.cells.set(cell);
  }
  return constellation;
}

std::vector<GraspPlace> graspPlaces(const BoxTree& tree, const std::vector<const Grasp*>& grasps) {
  const Pose X_BC = tree.nodes.front().box.X_CB.inverse();
  const double unit_m = unitOf(tree);
  std::vector<GraspPlace> places;
  for (const Grasp* grasp : grasps) {
    const auto& [f1, f2, thumb] = grasp->contacts;
    const Vector3d mean_C = (f1.p_C + f2.p_C + thumb.p_C) / 3.0,
                   across_C = thumb.p_C - (f1.p_C + f2.p_C) / 2.0;
    places.push_back(
        {X_BC * mean_C / unit_m, X_BC.linear() * grasp->approach_C, X_BC.linear() * across_C.normalized()});
  }
  return places;
}

}  // namespace boxgrasp
