// Fit-and-split decomposition of a cloud into a tree of minimum volume boxes (paper II, Alg. II.1).
#pragma once

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/decomposition/box_tree.h"

namespace boxgrasp {

enum class SplitRule {
  hull,    // the paper's new rule (II.A): cuts between hull segments, scored by
           // convex hull areas (Eq. 1)
  bound,   // the old rule (Alg. II.2): cuts parallel to the face's edges, scored
           // by bounding rectangles
  robust,  // past the paper: a jury of decompositions of the smoothed, evened
           // surface votes. Nearly the same tree for noisy, thinned or unevenly sampled clouds of one shape;
           // slower. Noise and strays stick out of boxes. Always measures t on the sum, and makes no use of
           // the options from segment_fraction to min_point_fraction, bound_step_m and exhaustive
};

// What the volume test `percentualVolume(p + q, box) < t` of Alg. II.1 is measured on.
enum class GainMeasure {
  local,  // (V(p) + V(q)) / V(box)
  sum,    // the sum over all boxes after the split / before it; boxes are split
          // breadth first. Near the paper's pictures.
};

struct DecompositionOptions {
  double gain_t = 0.90;  // t of Alg. II.1 and Fig. 2; towards 1: more boxes
  SplitRule split = SplitRule::hull;
  GainMeasure gain = GainMeasure::sum;
  double segment_fraction = 0.10;    // hull segments shorter than this share of
                                     // the hull's perimeter make no cuts (II.A)
  int samples_per_segment = 7;       // cut end points on each long hull segment
                                     // (II.A); more: finer cuts, slower
  double merge_angle_rad = 0.09;     // neighbouring hull segments that turn less than this count as one:
                                     // noise breaks long segments into short ones
  double min_point_fraction = 0.02;  // a side of a cut with fewer points than this share of the box's is
                                     // refused: such cuts split off outliers and rank first otherwise
  int min_points = 50;               // boxes with fewer points are not split: too few to
                                     // carry a face image
  double min_extent_m = 0.010;       // boxes whose second extent is below this are
                                     // not split: thinner than a finger
  double bound_step_m = 0.001;       // distance between the cuts that the bound rule
                                     // tries: one pixel of Alg. II.2
  int max_leaves = 64;               // bounds the work on pathological clouds
  int jurors = 7;                    // of the robust rule: more are steadier and slower
  double resolution_fraction =
      0.03;  // of the robust rule: the smoothing, as a share of the cloud's
             // size; parts thinner than this have no thickness, noise smaller than this no effect
  bool exhaustive = false;  // the plain algorithm, every cut on all points;
                            // slow, the tests' oracle
  int threads = 1;          // 0 = all cores; the result does not depend on it

  void validate() const;
};

// The box tree of the cloud. Every node keeps its box, its best split and its points; children partition
// their parent's points. Throws InputError for an empty or non-finite cloud or bad options, Stopped when told
// to stop.
BoxTree decompose(const PointCloud& cloud_C, const DecompositionOptions& options = {},
                  const StopToken& stop = {});

}  // namespace boxgrasp
