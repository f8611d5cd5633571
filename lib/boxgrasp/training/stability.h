// How much of a decomposition survives noise, missing points and another t (paper II.B, Table I and Fig. 3).
#pragma once

#include <cstdint>
#include <vector>

#include "boxgrasp/decomposition/decompose.h"
#include "boxgrasp/decomposition/similarity.h"

namespace boxgrasp {

// What is done to a cloud. The paper counts the levels of the first two and names no amounts; the last two go
// past it.
enum class Damage {
  noise,  // every coordinate moves by a normal deviate; amount: its standard deviation over the cloud's size
  removal,   // points vanish at random; amount: their share
  outliers,  // points anywhere in the cloud's bounds, doubled in size, are added; amount: their share
  fading,    // points vanish the more the farther along a random direction; amount: the share at the far end
};

// Levels run evenly up to the greatest amount: level k of n has k / n of it. Sizes are the largest extent of
// the cloud's minimum volume box, which is also the scale of Eq. 2's D and V.
struct StabilityOptions {
  int noise_levels = 19;       // as many as in the paper
  double max_noise = 0.019;    // 2 mm on 0.1 m: what a depth camera does from near by
  int removal_levels = 14;     // as many as in the paper
  double max_removal = 0.70;   // a cloud that keeps fewer points has holes
  int outlier_levels = 0;      // past the paper: 0 leaves them out
  double max_outliers = 0.02;  // more are the business of cleaning
  int fading_levels = 0;       // past the paper: 0 leaves it out
  double max_fading = 0.8;     // density falls to a fifth over the object
  std::uint64_t seed = 1;      // of all damage
  int threads = 1;             // 0 = all cores; the result does not depend on it

  DecompositionOptions decomposition;
  SimilarityOptions similarity;  // of Eq. 2; its scale is set as said above where it is -1

  void validate() const;
};

// The damaged cloud; the points that stay keep their order. Pre: 0 <= amount, below 1 for removal and fading.
PointCloud damaged(const PointCloud& cloud, Damage damage, double amount, double size_m, std::uint64_t seed);

// One damaged cloud's decomposition beside that of the undamaged one.
struct StabilityTrial {
  Damage damage = Damage::noise;
  double amount = -1.0;
  std::size_t boxes = 0;
  double distance_difference = -1.0;  // |D_i - D_j| of Eq. 2
  double volume_difference = -1.0;    // |V_i - V_j|
  bool similar = false;
};

struct StabilityReport {
  std::size_t boxes = 0;  // of the undamaged cloud's decomposition
  std::vector<StabilityTrial> trials;

  double similarShare() const;               // of all trials, 0..1; -1 without trials
  double similarShare(Damage damage) const;  // of those with this damage
};

// Table I for one cloud. Throws InputError for bad options or an unusable cloud, Stopped when told to stop.
StabilityReport measureStability(const PointCloud& cloud, const StabilityOptions& options,
                                 const StopToken& stop = {});

// The constellation of one cloud at one t.
struct GainPoint {
  double t = -1.0;
  std::size_t boxes = 0;
  double volume = -1.0;          // of all leaves, as a share of the root box
  bool similar_to_last = false;  // by Eq. 2, to that of the t before; false for the first
};

// Fig. 3 as numbers: the constellations for each t, in the given order.
std::vector<GainPoint> constellationsOver(const std::vector<double>& gains, const PointCloud& cloud,
                                          const DecompositionOptions& options,
                                          const SimilarityOptions& similarity = {},
                                          const StopToken& stop = {});

}  // namespace boxgrasp
