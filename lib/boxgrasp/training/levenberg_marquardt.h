// Training by Levenberg-Marquardt (paper IV.A, IV.C).
#pragma once

#include <functional>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/ranking/network.h"

namespace boxgrasp {

// One grasp a row.
struct Samples {
  MatrixXd inputs;    // n x features
  VectorXd targets;   // n
};

struct LevenbergMarquardtOptions {
  std::vector<int> hidden = {8};   // nodes of each hidden layer (paper IV.C: 8)
  int max_epochs = 100;            // "no training phase required more than 100 epochs"
  int max_validation_failures = 6; // early stopping: epochs in a row without a better validation error
  double mu = 1e-3, mu_decrease = 0.1, mu_increase = 10.0, mu_max = 1e10;  // damping, the customary schedule
  double min_gradient = 1e-7;      // stop when the gradient's norm falls below this
  int starts = 3;                  // seeded starts; the best on the validation set (else the training set) wins
  std::uint64_t seed = 1;
  void validate() const;
};

struct TrainingReport {
  std::vector<double> training_mse, validation_mse;   // of the winning start, per epoch, in normalised units
  int best_epoch = -1;
  int best_start = -1;
  std::string stop_reason;
  double time_s = -1.0;
};

struct Trained {
  Network network;
  TrainingReport report;
};

// Trains a network; `validation` may be empty (no early stopping). Same data, options and seed: the same network to the bit.
Trained train(const Samples& training, const Samples& validation, const LevenbergMarquardtOptions& options = {},
              const StopToken& stop = {});

// Residuals (network - target, in normalised units) and their Jacobian by all weights; for tests against numeric derivatives.
struct ResidualsAndJacobian {
  VectorXd residuals;   // n
  MatrixXd jacobian;    // n x parameters
};
ResidualsAndJacobian residualsAndJacobian(const Network& network, const Samples& samples);
VectorXd parameters(const Network& network);
void setParameters(Network& network, const VectorXd& parameters);

}  // namespace boxgrasp
