// A hand-made model for tests that need a ranking, but not a good one.
#pragma once

#include <fmt/format.h>

#include "boxgrasp/ranking/model_file.h"

namespace boxgrasp::test {

// Linear in the measures: a large grasp triangle (q1) is good, everything else is bad, each over a plausible
// range.
inline Model linearModel() {
  Model model;
  model.name = "test";
  model.version = "00000000";
  for (int q = 1; q <= 9; ++q) model.features.push_back(fmt::format("q{}", q));
  Network& network = model.ensemble.networks.emplace_back();
  network.input.min = VectorXd::Zero(9);
  network.input.max = (VectorXd(9) << 5e-3, 1.0, 1.0, 0.1, 1.5, 0.1, 0.05, 1e-3, 0.1).finished();
  network.output.min = VectorXd::Zero(1);
  network.output.max = VectorXd::Ones(1);
  MatrixXd weights = MatrixXd::Constant(1, 9, -0.1);
  weights(0, 0) = 0.2;
  network.layers.push_back({weights, VectorXd::Zero(1)});
  return model;
}

}  // namespace boxgrasp::test
