#include "boxgrasp/ranking/ensemble.h"

#include <cmath>

#include "boxgrasp/base/error.h"
#include "boxgrasp/ranking/activation.h"

namespace boxgrasp {

void Ensemble::validate() const {
  if (networks.empty() || networks.size() > kMaxNetworks) {
    throw InputError(fmt::format("the model has {} networks, but must have 1 to {}; train it again",
                                 networks.size(), kMaxNetworks));
  }
  for (std::size_t i = 0; i < networks.size(); ++i) {
    try {
      networks[i].validate();
    } catch (const InputError& error) {
      throw InputError(fmt::format("networks[{}]: {}", i, error.what()));
    }
    if (networks[i].inputs() != inputs()) {
      throw InputError(fmt::format("networks[{}] takes {} inputs, but networks[0] {}; train the model again",
                                   i, networks[i].inputs(), inputs()));
    }
  }
  if (!calibration) return;
  requireOption(calibration->slope > 0 && std::isfinite(calibration->slope), "calibration.slope",
                calibration->slope, "positive and finite");
  requireOption(std::isfinite(calibration->offset), "calibration.offset", calibration->offset, "finite");
}

// 1 / (1 + exp(-x)) = (1 + tanh(x / 2)) / 2.
VectorXd calibrated(const Calibration& calibration, VectorXd scores) {
  for (double& score : scores) score = 0.5 * (calibration.slope * score + calibration.offset);
  tanhInPlace(scores.data(), static_cast<std::size_t>(scores.size()));
  for (double& score : scores) score = 0.5 + 0.5 * score;
  return scores;
}

VectorXd scores(const Ensemble& ensemble, const MatrixXd& measures) {
  VectorXd sum = VectorXd::Zero(measures.rows());
  for (const Network& network : ensemble.networks) sum += scores(network, measures);
  const VectorXd mean = sum / static_cast<double>(ensemble.networks.size());
  return ensemble.calibration ? calibrated(*ensemble.calibration, mean) : mean;
}

}  // namespace boxgrasp
