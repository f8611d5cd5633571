// Networks for tests.
#pragma once

#include <random>
#include <vector>

#include "boxgrasp/base/random.h"
#include "boxgrasp/ranking/network.h"

namespace boxgrasp::test {

inline MatrixXd randomMatrix(Eigen::Index rows, Eigen::Index cols, std::mt19937_64& random) {
  MatrixXd m(rows, cols);
  for (double& x : m.reshaped()) x = normal(random);
  return m;
}

// widths: inputs, hidden nodes of each layer; one output is added.
inline Network randomNetwork(const std::vector<int>& widths, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Network network;
  network.input.min = randomMatrix(widths.front(), 1, random);
  network.input.max = network.input.min + randomMatrix(widths.front(), 1, random).cwiseAbs();
  network.output = {VectorXd::Constant(1, -0.25), VectorXd::Constant(1, 1.75)};
  for (std::size_t l = 0; l < widths.size(); ++l) {
    const int nodes = l + 1 < widths.size() ? widths[l + 1] : 1;
    network.layers.push_back({randomMatrix(nodes, widths[l], random), randomMatrix(nodes, 1, random)});
  }
  return network;
}

}  // namespace boxgrasp::test
