// The feed-forward network that scores a grasp from its quality measures (paper IV.C).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace boxgrasp {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Maps every input to [-1, 1] by its range in the training data, and outputs back. A feature that was constant maps to 0.
struct Normalisation {
  VectorXd min;
  VectorXd max;
  VectorXd apply(const VectorXd& x) const;    // to [-1, 1]
  VectorXd invert(const VectorXd& y) const;   // from [-1, 1]
};

struct Layer {
  MatrixXd weights;  // outputs x inputs
  VectorXd bias;     // outputs
};

// tanh in the hidden layers, linear output, one output. layers.size() - 1 hidden layers.
struct Network {
  Normalisation input;
  Normalisation output;
  std::vector<Layer> layers;

  int inputs() const;
  // Throws InputError that names the layer for shapes that do not fit together or numbers that are not finite.
  void validate() const;
};

// The predicted success of one grasp; higher is better. Inputs are clamped to 1.5 times their training range about its centre, because a
// network says nothing about what lies far outside its data. Pre: measures.size() == network.inputs().
double score(const Network& network, const VectorXd& measures);

// The same for one grasp a row.
VectorXd scores(const Network& network, const MatrixXd& measures);

}  // namespace boxgrasp
