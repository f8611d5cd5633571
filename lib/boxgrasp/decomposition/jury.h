// The robust decomposition: several jurors decompose the cloud, each from another view of its surface, and
// vote. Past the paper; for II.B's sake.
#pragma once

#include "boxgrasp/decomposition/decompose.h"
#include "boxgrasp/decomposition/plateau_cuts.h"

namespace boxgrasp {

// One part of the surface in a juror's tree, and the best cut through it.
struct JurorNode {
  PointCloud points_C;  // of the even surface
  OrientedBox box;      // of least volume around them
  double volume = 0.0;  // of the box with a skin of half the resolution: what is
                        // thinner says nothing
  int parent = -1, first = -1, second = -1, depth = 0;
  PlateauCut cut;           // through this part; its theta is -1 where there is none
  double cut_volume = 0.0;  // of both sides of the cut, with skin; infinite where there is none
};

// A juror splits the part whose cut saves most, again and again: after k splits, nodes [0, 2 k] are its tree.
// Deciding in order of what is saved, not top down, keeps a doubtful early split from changing the later
// ones.
struct Juror {
  double resolution_m = -1.0;  // of the surface that it looked at
  std::vector<JurorNode> nodes;
  std::vector<double> volumes;    // [k]: summed over the leaves after k splits
  std::vector<double> distances;  // [k]: between all pairs of leaves' centres (D
                                  // of Eq. 2), metres

  bool leafAfter(std::size_t node, std::size_t splits) const;
};

// The opinion of juror `number`, whose voxels are turned and sized its own way.
Juror hearJuror(const PointCloud& cloud_C, int number, const DecompositionOptions& options,
                const StopToken& stop);

struct Verdict {
  std::size_t splits = 0;
  std::size_t juror = 0;     // whose tree it is
  double next_ratio = -1.0;  // of volumes after and before one split more, the
                             // median over the jury
};

// A split is worth its box where it leaves less than a share of the volume that lies near t: in the widest
// gap between the ratios that the median juror finds, from 0.6 (1 - t) below t to 0.8 (1 - t) above it, so
// that small errors in the ratios do not change the number of splits. Of the trees with that many splits the
// verdict is that of the juror with whose D most others agree.
Verdict verdictOf(const std::vector<Juror>& jury, const DecompositionOptions& options);

// The tree of the verdict, with the cloud's own points. Boxes hold the smoothed surface and half its
// resolution more on each side: noise and strays may stick out, but do not move the boxes.
BoxTree juryTree(const PointCloud& cloud_C, const DecompositionOptions& options, const StopToken& stop);

}  // namespace boxgrasp
