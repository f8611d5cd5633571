#include "boxgrasp/decomposition/similarity.h"

#include <cmath>

#include "boxgrasp/base/error.h"

namespace boxgrasp {

void SimilarityOptions::validate() const {
  requireOption(max_distance_difference >= 0, "max_distance_difference", max_distance_difference,
                "at least 0");
  requireOption(max_volume_difference >= 0, "max_volume_difference", max_volume_difference, "at least 0");
  requireOption(scale_m > 0 || scale_m == -1.0, "scale_m", scale_m,
                "positive, or -1 for the extent of the first root box");
}

ConstellationSize constellationSize(const BoxTree& tree, double scale_m) {
  ConstellationSize size{tree.leafVolume() / (scale_m * scale_m * scale_m), 0.0};
  const std::vector<int> leaves = tree.leaves();
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    for (std::size_t j = i + 1; j < leaves.size(); ++j) {
      const Vector3d between =
          tree.nodes[leaves[i]].box.X_CB.translation() - tree.nodes[leaves[j]].box.X_CB.translation();
      size.distance += between.norm() / scale_m;
    }
  }
  return size;
}

bool similar(const BoxTree& a, const BoxTree& b, const SimilarityOptions& options) {
  options.validate();
  if (a.nodes.empty() || b.nodes.empty())
    throw InputError("similarity needs two decompositions that have at least one box each");
  const double scale_m = options.scale_m > 0 ? options.scale_m : a.nodes.front().box.extents.maxCoeff();
  const ConstellationSize size_a = constellationSize(a, scale_m), size_b = constellationSize(b, scale_m);
  return std::abs(size_a.distance - size_b.distance) <= options.max_distance_difference &&
         std::abs(size_a.volume - size_b.volume) <= options.max_volume_difference;
}

}  // namespace boxgrasp
