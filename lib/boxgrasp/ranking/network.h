// The feed-forward network that scores a grasp from its quality measures (paper IV.C).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace boxgrasp {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Maps every input to [-1, 1] by its range in the training data, and outputs back. A feature that was
// constant maps to 0, and back to its constant. Pre: as many features (entries, columns) as the ranges have.
struct Normalisation {
  VectorXd min;
  VectorXd max;
  VectorXd apply(const VectorXd& x) const;      // to [-1, 1]
  VectorXd invert(const VectorXd& y) const;     // from [-1, 1]
  MatrixXd applyRows(const MatrixXd& x) const;  // the same for one sample a row
  MatrixXd invertRows(const MatrixXd& y) const;
};

struct Layer {
  MatrixXd weights;  // outputs x inputs
  VectorXd bias;     // outputs
};

// tanh in the hidden layers, linear output, one output. layers.size() - 1 hidden layers.
struct Network {
  static constexpr int kMaxLayers = 8;
  static constexpr int kMaxNodes = 1024;  // of a layer, and inputs

  Normalisation input;
  Normalisation output;
  std::vector<Layer> layers;

  int inputs() const;
  // Throws InputError that names the layer for shapes that do not fit together, more layers or nodes than the
  // limits, or numbers that are not finite.
  void validate() const;
};

// The predicted success of one grasp; higher is better. Inputs are clamped to 1.5 times their training range
// about its centre, because a network says nothing about what lies far outside its data. A NaN among the
// measures gives NaN. Pre: the network is valid and measures.size() == network.inputs().
double score(const Network& network, const VectorXd& measures);

// The same for one grasp a row. Each row's score has the same bits whatever the other rows are and on every
// machine.
VectorXd scores(const Network& network, const MatrixXd& measures);

// The measures as the first layer takes them: normalised and clamped. One sample a row.
MatrixXd normalisedInputs(const Network& network, const MatrixXd& measures);

// What each layer puts out in normalised units, one sample a row: first the inputs themselves, last the
// output. The one forward pass, shared with training.
std::vector<MatrixXd> activations(const Network& network, const MatrixXd& normalised_inputs);

}  // namespace boxgrasp
