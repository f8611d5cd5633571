// Similarity of two decompositions (paper II.B, Eq. 2).
#pragma once

#include "boxgrasp/decomposition/box_tree.h"

namespace boxgrasp {

struct SimilarityOptions {
  double max_distance_difference = 0.1;  // bound on |D_i - D_j| (Eq. 2)
  double max_volume_difference = 0.9;    // bound on |V_i - V_j| (Eq. 2)
  double scale_m =
      -1.0;  // the length that counts as 1 in D and V; -1: the largest extent of the first tree's root box
  void validate() const;
};

// V: summed volume of the leaves; D: summed distance between the centres of all pairs of leaves; both in
// units of the scale.
struct ConstellationSize {
  double volume = -1.0;
  double distance = -1.0;
};
ConstellationSize constellationSize(const BoxTree& tree, double scale_m);

bool similar(const BoxTree& a, const BoxTree& b, const SimilarityOptions& options = {});

}  // namespace boxgrasp
