#include "boxgrasp/simulation/perturbation.h"

#include <cassert>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"

namespace boxgrasp {
namespace {

std::mt19937_64 generatorOf(std::uint64_t seed, int k) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                         static_cast<std::uint32_t>(k)};
  return std::mt19937_64(sequence);
}

// Uniform in the unit ball.
Vector3d inBall(std::mt19937_64& random) {
  while (true) {
    const double x = uniform(random, -1, 1), y = uniform(random, -1, 1), z = uniform(random, -1, 1);
    if (const Vector3d p(x, y, z); p.squaredNorm() <= 1) return p;
  }
}

Matrix3d turnBy(const Vector3d& rotation_vector) {
  return Eigen::AngleAxisd(rotation_vector.norm(), rotation_vector.stableNormalized()).toRotationMatrix();
}

}  // namespace

void PerturbationOptions::validate() const {
  requireOption(shift_m >= 0, "shift_m", shift_m, "at least 0");
  requireOption(turn_rad >= 0 && turn_rad <= std::numbers::pi, "turn_rad", turn_rad, "0 to pi");
  requireOption(friction_share >= 0 && friction_share < 1, "friction_share", friction_share, "0 to below 1");
  requireOption(mass_share >= 0 && mass_share < 1, "mass_share", mass_share, "0 to below 1");
}

PerturbedTrial perturbed(const TrialInput& input, const TrialOptions& options,
                         const PerturbationOptions& perturbation, std::uint64_t seed, int k) {
  assert(k >= 0);
  perturbation.validate();
  PerturbedTrial trial{input, options};
  if (k == 0) return trial;
  std::mt19937_64 random = generatorOf(seed, k);
  const Vector3d shift_P = perturbation.shift_m * inBall(random);
  const Matrix3d turn_P = turnBy(perturbation.turn_rad * inBall(random));
  trial.input.X_OP = input.X_OP * makePose(turn_P, shift_P);
  trial.options.physics.friction *= 1 + perturbation.friction_share * uniform(random, -1, 1);
  trial.options.physics.mass_factor *= 1 + perturbation.mass_share * uniform(random, -1, 1);
  return trial;
}

}  // namespace boxgrasp
