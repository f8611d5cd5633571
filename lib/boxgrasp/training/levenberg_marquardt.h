// Training by Levenberg-Marquardt (paper IV.A, IV.C).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/ranking/network.h"

namespace boxgrasp {

// One grasp a row.
struct Samples {
  MatrixXd inputs;   // n x features
  VectorXd targets;  // n
  // n: how much each row's squared error counts, relative to the others; empty: all the same. Two rows of
  // weight 1 that are equal count as one of weight 2.
  VectorXd weights{};
};

// Throws InputError, naming the set and the row and column, for numbers that are not finite, for other
// numbers of rows and of targets or weights, for no or too many features, and for weights below 0 or all 0.
void checkSamples(const Samples& samples, const std::string& set);

// These rows in this order. Pre: 0 <= each < samples.targets.size().
Samples selectRows(const Samples& samples, const std::vector<Eigen::Index>& rows);

struct LevenbergMarquardtOptions {
  std::vector<int> hidden = {8};  // nodes of each hidden layer (paper IV.C: 8); empty for a linear model
  int max_epochs = 100;  // "no training phase required more than 100 epochs"; 0 keeps the first guess
  int max_validation_failures = 6;  // early stopping: epochs in a row without a better validation error
  double mu = 1e-3;                 // first damping, added to the diagonal of J^T J / n
  double mu_decrease = 0.1;         // factor of the damping after a step that helped: the customary schedule
  double mu_increase = 10.0;        // and after one that did not
  double mu_max = 1e10;             // no step helps beyond this damping: stop
  double min_gradient =
      1e-7;        // stop when the norm of half the gradient of the mean squared error is below this
  int starts = 3;  // seeded starts; the best on the validation set (else the training set) wins
  std::uint64_t seed = 1;
  void validate() const;
};

// Normalised units: inputs and targets mapped to [-1, 1] by their range in the training samples.
struct TrainingReport {
  std::vector<double> training_mse;    // of the winning start; [0] before the first epoch, [e] after e epochs
  std::vector<double> validation_mse;  // the same; empty without a validation set
  int best_epoch = -1;                 // index into these: the epoch whose weights were kept
  int best_start = -1;
  std::string stop_reason;  // of the winning start, in words
  double time_s = -1.0;     // of all starts
};

struct Trained {
  Network network;
  TrainingReport report;
};

// Trains a network; `validation` may be empty (no early stopping: the last epoch's weights are kept; with it,
// those of the epoch with the least validation error). The first weights are Nguyen and Widrow's. Same data,
// options and seed: the same network to the bit. Throws InputError for no samples, shapes that do not match,
// numbers that are not finite (naming row and column), or a network of more than 4096 weights.
Trained train(const Samples& training, const Samples& validation,
              const LevenbergMarquardtOptions& options = {}, const StopToken& stop = {});

// Residuals (network - target, in normalised units) and their Jacobian by all weights; for tests against
// numeric derivatives.
struct ResidualsAndJacobian {
  VectorXd residuals;  // n
  MatrixXd jacobian;   // n x parameters
};
ResidualsAndJacobian residualsAndJacobian(const Network& network, const Samples& samples);

// All weights as one vector: layer by layer, node by node, the node's weights and then its bias.
VectorXd parameters(const Network& network);
// Pre: as many parameters as parameters() gives.
void setParameters(Network& network, const VectorXd& parameters);

}  // namespace boxgrasp
