#include "boxgrasp/simulation/perturbation.h"

#include <gtest/gtest.h>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

TrialInput somewhere() {
  TrialInput input;
  input.X_OP = makePose(Eigen::AngleAxisd(1.0, Vector3d(1, 2, 3).normalized()).toRotationMatrix(),
                        Vector3d(0.1, -0.2, 0.3));
  return input;
}

TEST(Perturbation, ZerothIsTheTrialItself) {
  const PerturbedTrial trial = perturbed(somewhere(), {}, {}, 7, 0);
  EXPECT_EQ(trial.input.X_OP.matrix(), somewhere().X_OP.matrix());
  EXPECT_EQ(trial.options.physics.friction, TrialOptions{}.physics.friction);
  EXPECT_EQ(trial.options.physics.mass_factor, 1.0);
}

TEST(Perturbation, DependsOnSeedAndNumberAlone) {
  const auto poseOf = [](std::uint64_t seed, int k) {
    return perturbed(somewhere(), {}, {}, seed, k).input.X_OP.matrix();
  };
  EXPECT_EQ(poseOf(7, 3), poseOf(7, 3));
  EXPECT_NE(poseOf(7, 3), poseOf(7, 4));
  EXPECT_NE(poseOf(7, 3), poseOf(8, 3));
  EXPECT_NE(poseOf(7, 3), poseOf(7 + (std::uint64_t{1} << 32), 3)) << "the seed's upper half is not used";
}

TEST(Perturbation, FillsItsBoundsEvenlyAndNeverLeavesThem) {
  const PerturbationOptions options;
  constexpr int kCount = 2000;
  double farthest = 0, widest = 0, least_mass = 2, most_mass = 0, least_friction = 2, most_friction = 0;
  Vector3d mean_shift = Vector3d::Zero(), mean_turn = Vector3d::Zero();
  for (int k = 1; k <= kCount; ++k) {
    const PerturbedTrial trial = perturbed(somewhere(), {}, options, 7, k);
    const Pose change = somewhere().X_OP.inverse() * trial.input.X_OP;
    const Eigen::AngleAxisd turn(Matrix3d(change.linear()));
    farthest = std::max(farthest, change.translation().norm());
    widest = std::max(widest, turn.angle());
    mean_shift += change.translation() / kCount;
    mean_turn += turn.angle() * turn.axis() / kCount;
    least_mass = std::min(least_mass, trial.options.physics.mass_factor);
    most_mass = std::max(most_mass, trial.options.physics.mass_factor);
    least_friction = std::min(least_friction, trial.options.physics.friction);
    most_friction = std::max(most_friction, trial.options.physics.friction);
  }
  const auto expectFilled = [](double reached, double bound) {
    EXPECT_LE(reached, bound * (1 + 1e-9));
    EXPECT_GT(reached, 0.98 * bound);
  };
  expectFilled(farthest, options.shift_m);
  expectFilled(widest, options.turn_rad);
  expectFilled(most_mass - 1, options.mass_share);
  expectFilled(1 - least_mass, options.mass_share);
  expectFilled(most_friction / 0.5 - 1, options.friction_share);
  expectFilled(1 - least_friction / 0.5, options.friction_share);
  EXPECT_LT(mean_shift.norm(), 0.05 * options.shift_m);
  EXPECT_LT(mean_turn.norm(), 0.05 * options.turn_rad);
}

TEST(Perturbation, RefusesBadOptions) {
  EXPECT_THROW(perturbed({}, {}, {.shift_m = -1}, 0, 1), InputError);
  EXPECT_THROW(perturbed({}, {}, {.friction_share = 1}, 0, 1), InputError);
  EXPECT_THROW(perturbed({}, {}, {.mass_share = NAN}, 0, 1), InputError);
  EXPECT_THROW(perturbed({}, {}, {.turn_rad = 4}, 0, 1), InputError);
}

}  // namespace
}  // namespace boxgrasp
