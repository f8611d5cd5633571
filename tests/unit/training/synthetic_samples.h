// Samples of known functions.
#pragma once

#include "boxgrasp/base/random.h"
#include "boxgrasp/training/levenberg_marquardt.h"

namespace boxgrasp::test {

inline Samples noSamples(Eigen::Index features) { return {MatrixXd(0, features), VectorXd(0)}; }

// Inputs uniform in [-1, 1].
template <typename Function>
Samples sampled(Eigen::Index n, Eigen::Index features, std::uint64_t seed, Function&& function) {
  std::mt19937_64 random(seed);
  Samples samples{MatrixXd(n, features), VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < features; ++j) samples.inputs(i, j) = uniform(random, -1.0, 1.0);
    samples.targets[i] = function(VectorXd(samples.inputs.row(i)));
  }
  return samples;
}

inline Samples noisy(Eigen::Index n, Eigen::Index features, std::uint64_t seed) {
  std::mt19937_64 random(seed ^ 0x9e3779b9);
  return sampled(n, features, seed, [&](const VectorXd& x) {
    return std::sin(2.0 * x[0]) + x[1] * x[2] + 0.3 * normal(random);
  });
}

}  // namespace boxgrasp::test
