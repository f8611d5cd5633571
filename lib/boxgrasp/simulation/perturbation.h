// The same grasp, not quite as planned: what a robot executes.
#pragma once

#include <cstdint>
#include <numbers>

#include "boxgrasp/simulation/trial.h"

namespace boxgrasp {

struct PerturbationOptions {
  // The palm is displaced by up to this, in any direction: what a calibrated arm and depth camera err by.
  double shift_m = 0.005;
  // And turned by up to this about its origin, about any axis, which moves the fingertips by up to 9 mm.
  double turn_rad = 5.0 * std::numbers::pi / 180;
  double friction_share = 0.2;  // friction is known no better: dust, moisture, wear
  double mass_share = 0.2;      // nor is the mass of a thing that was only seen
  void validate() const;
};

struct PerturbedTrial {
  TrialInput input;
  TrialOptions options;  // physics.friction and physics.mass_factor differ
};

// The k-th perturbation of a trial; the 0th is the trial itself. Shift and turn are uniform in a ball of
// their bound, friction and mass uniform within their shares of what they were. Depends on nothing but what
// is passed. Throws InputError for bad perturbation options; assert: k >= 0.
PerturbedTrial perturbed(const TrialInput& input, const TrialOptions& options,
                         const PerturbationOptions& perturbation, std::uint64_t seed, int k);

}  // namespace boxgrasp
