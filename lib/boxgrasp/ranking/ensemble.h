// Several networks that score together, and what their score means.
#pragma once

#include <optional>
#include <vector>

#include "boxgrasp/ranking/network.h"

namespace boxgrasp {

// Turns a score x into the probability 1 / (1 + exp(-(slope x + offset))) that the grasp holds (Platt 1999).
// The slope is positive, so that the order of grasps stays.
struct Calibration {
  double slope = 1.0;
  double offset = 0.0;
};

// Networks of the same inputs, whose outputs are averaged: what they have learnt of the data they share, what
// they have learnt of their chance beginnings cancels.
struct Ensemble {
  static constexpr int kMaxNetworks = 64;

  std::vector<Network> networks;
  std::optional<Calibration> calibration;  // none: the score is the mean output of the networks

  int inputs() const { return networks.front().inputs(); }  // Pre: valid
  // Throws InputError that names the network for no or too many networks, other numbers of inputs, whatever
  // Network::validate() refuses, or a slope that is not positive and finite.
  void validate() const;
};

// One grasp a row; higher is better, a probability in [0, 1] with a calibration. As scores() of a network:
// each row's bits do not depend on the other rows or on the machine, and NaN stays NaN. Pre: valid.
VectorXd scores(const Ensemble& ensemble, const MatrixXd& measures);

// The calibration alone, on any scores.
VectorXd calibrated(const Calibration& calibration, VectorXd scores);

}  // namespace boxgrasp
