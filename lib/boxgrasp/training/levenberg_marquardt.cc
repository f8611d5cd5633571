#include "boxgrasp/training/levenberg_marquardt.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/training/normal_equations.h"

namespace boxgrasp {
namespace {

using Eigen::Index;

constexpr Index kMaxParameters = 4096;
constexpr Index kBlockRows = 64;  // a block of the Jacobian stays in the second-level cache
constexpr double kMinMu = 1e-20;  // repeated decreases must not reach zero, from where no increase leads back

struct NormalisedSamples {
  MatrixXd inputs;
  VectorXd targets;
  VectorXd weight_roots;  // of weights whose mean is 1; empty: all 1
};

NormalisedSamples normalised(const Samples& samples, const Network& network) {
  NormalisedSamples set{
      normalisedInputs(network, samples.inputs), network.output.applyRows(samples.targets), {}};
  if (samples.weights.size() > 0) set.weight_roots = (samples.weights / samples.weights.mean()).cwiseSqrt();
  return set;
}

Index parameterCount(const Network& network) {
  Index count = 0;
  for (const Layer& layer : network.layers) count += layer.weights.size() + layer.bias.size();
  return count;
}

// Residuals of some rows, and the derivative of each row's output by all parameters.
struct Linearisation {
  NormalEquations::Block jacobian;
  VectorXd residuals;
};

// sensitivities: derivative of the output by each node's sum, one sample a row.
void fillLayer(const Layer& layer, const MatrixXd& inputs, const MatrixXd& sensitivities, Index first,
               NormalEquations::Block& jacobian) {
  for (Index o = 0; o < layer.weights.rows(); ++o) {
    const auto sensitivity = sensitivities.col(o);
    for (Index i = 0; i < inputs.cols(); ++i) jacobian.col(first++) = sensitivity.cwiseProduct(inputs.col(i));
    jacobian.col(first++) = sensitivity;
  }
}

// Back-propagation through one layer; the derivative of tanh is 1 - tanh^2.
MatrixXd sensitivitiesBefore(const Layer& layer, const MatrixXd& inputs, const MatrixXd& sensitivities) {
  MatrixXd before = MatrixXd::Zero(inputs.rows(), inputs.cols());
  for (Index i = 0; i < inputs.cols(); ++i) {
    for (Index o = 0; o < layer.weights.rows(); ++o)
      before.col(i) += layer.weights(o, i) * sensitivities.col(o);
    before.col(i).array() *= 1.0 - inputs.col(i).array().square();
  }
  return before;
}

Linearisation linearise(const Network& network, const MatrixXd& inputs, const VectorXd& targets) {
  const std::vector<MatrixXd> outputs = activations(network, inputs);
  Index end = parameterCount(network);
  Linearisation result;
  result.residuals = outputs.back().col(0) - targets;
  result.jacobian.setZero(inputs.rows(), NormalEquations::padded(end));
  MatrixXd sensitivities = MatrixXd::Ones(inputs.rows(), 1);
  for (std::size_t l = network.layers.size(); l-- > 0;) {
    const Layer& layer = network.layers[l];
    end -= layer.weights.size() + layer.bias.size();
    fillLayer(layer, outputs[l], sensitivities, end, result.jacobian);
    if (l > 0) sensitivities = sensitivitiesBefore(layer, outputs[l], sensitivities);
  }
  return result;
}

void weigh(const VectorXd& roots, Linearisation& block) {
  block.residuals.array() *= roots.array();
  for (Index n = 0; n < roots.size(); ++n) block.jacobian.row(n) *= roots[n];
}

NormalEquations normalEquations(const Network& network, const NormalisedSamples& samples) {
  NormalEquations equations(parameterCount(network));
  for (Index first = 0; first < samples.targets.size(); first += kBlockRows) {
    const Index rows = std::min(kBlockRows, samples.targets.size() - first);
    Linearisation block =
        linearise(network, samples.inputs.middleRows(first, rows), samples.targets.segment(first, rows));
    if (samples.weight_roots.size() > 0) weigh(samples.weight_roots.segment(first, rows), block);
    equations.add(block.jacobian, block.residuals);
  }
  return equations;
}

double meanSquaredError(const Network& network, const NormalisedSamples& samples) {
  double sum = 0.0;
  for (Index first = 0; first < samples.targets.size(); first += kBlockRows) {
    const Index rows = std::min(kBlockRows, samples.targets.size() - first);
    const MatrixXd output = activations(network, samples.inputs.middleRows(first, rows)).back();
    for (Index n = 0; n < rows; ++n) {
      double error = output(n, 0) - samples.targets[first + n];
      if (samples.weight_roots.size() > 0) error *= samples.weight_roots[first + n];
      sum += error * error;
    }
  }
  return sum / static_cast<double>(samples.targets.size());
}

// --- first weights

MatrixXd uniformMatrix(Index rows, Index cols, std::mt19937_64& random) {
  MatrixXd m(rows, cols);
  for (Index r = 0; r < rows; ++r) {
    for (Index c = 0; c < cols; ++c) m(r, c) = uniform(random, -1.0, 1.0);
  }
  return m;
}

// Nguyen and Widrow 1990: each node's steep part crosses the inputs' cube [-1, 1]^n in a stripe of its own.
Layer hiddenLayer(Index nodes, Index inputs, std::mt19937_64& random) {
  const double length = 0.7 * std::pow(static_cast<double>(nodes), 1.0 / static_cast<double>(inputs));
  Layer layer{uniformMatrix(nodes, inputs, random), VectorXd::Zero(nodes)};
  for (Index o = 0; o < nodes; ++o) {
    layer.weights.row(o) *= length / layer.weights.row(o).norm();
    const double position =
        nodes == 1 ? 0.0 : 2.0 * static_cast<double>(o) / static_cast<double>(nodes - 1) - 1.0;
    layer.bias[o] = std::copysign(length * position, position * layer.weights(o, 0));
  }
  return layer;
}

std::vector<Layer> firstLayers(Index inputs, const std::vector<int>& hidden, std::uint64_t seed, int start) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                         static_cast<std::uint32_t>(start)};
  std::mt19937_64 random(sequence);
  std::vector<Layer> layers;
  for (const int nodes : hidden) {
    layers.push_back(hiddenLayer(nodes, inputs, random));
    inputs = nodes;
  }
  layers.push_back({uniformMatrix(1, inputs, random), uniformMatrix(1, 1, random).col(0)});
  return layers;
}

// --- one start

struct Problem {
  const NormalisedSamples& training;
  const NormalisedSamples& validation;
  const LevenbergMarquardtOptions& options;
  const StopToken& stop;
};

// A descent from one start, epoch by epoch.
class Descent {
 public:
  Descent(const Problem& problem, Network network)
      : problem_(problem), network_(std::move(network)), mu_(problem.options.mu) {
    record(meanSquaredError(network_, problem.training));
  }

  Trained run() {
    for (int epoch = 0; epoch < problem_.options.max_epochs && report_.stop_reason.empty(); ++epoch)
      advance();
    if (report_.stop_reason.empty()) report_.stop_reason = "limit of epochs reached";
    return {best_, report_};
  }

 private:
  bool hasValidation() const { return problem_.validation.targets.size() > 0; }

  void record(double training_mse) {
    report_.training_mse.push_back(training_mse);
    if (hasValidation()) report_.validation_mse.push_back(meanSquaredError(network_, problem_.validation));
    const auto& decisive = hasValidation() ? report_.validation_mse : report_.training_mse;
    const int epoch = static_cast<int>(decisive.size()) - 1;
    if (epoch == 0 || decisive.back() < decisive[static_cast<std::size_t>(report_.best_epoch)]) {
      best_ = network_;
      report_.best_epoch = epoch;
    } else if (hasValidation() && epoch - report_.best_epoch >= problem_.options.max_validation_failures) {
      report_.stop_reason = "validation error stopped falling";
    }
  }

  void advance() {
    problem_.stop.check();
    const NormalEquations equations = normalEquations(network_, problem_.training);
    const double n = static_cast<double>(problem_.training.targets.size());
    const VectorXd half_gradient = equations.vector() / n;
    if (half_gradient.norm() < problem_.options.min_gradient) {
      report_.stop_reason = "gradient vanished";
      return;
    }
    descend(equations.matrix() / n, half_gradient);
  }

  // Raises the damping until a step reduces the error.
  void descend(const MatrixXd& curvature, const VectorXd& half_gradient) {
    const VectorXd before = parameters(network_);
    for (; mu_ <= problem_.options.mu_max; mu_ *= problem_.options.mu_increase) {
      const auto step = dampedStep(curvature, half_gradient);
      if (!step) continue;
      setParameters(network_, before - *step);
      const double mse = meanSquaredError(network_, problem_.training);
      if (mse < report_.training_mse.back()) {
        mu_ = std::max(mu_ * problem_.options.mu_decrease, kMinMu);
        record(mse);
        return;
      }
    }
    setParameters(network_, before);
    report_.stop_reason = "no step reduces the error";
  }

  std::optional<VectorXd> dampedStep(MatrixXd curvature, const VectorXd& half_gradient) const {
    curvature.diagonal().array() += mu_;
    const Eigen::LLT<MatrixXd, Eigen::Lower> cholesky(curvature);
    if (cholesky.info() != Eigen::Success) return std::nullopt;
    const VectorXd step = cholesky.solve(half_gradient);
    return step.allFinite() ? std::optional(step) : std::nullopt;
  }

  const Problem& problem_;
  Network network_;
  Network best_;
  double mu_;
  TrainingReport report_;
};

// --- input

void checkFinite(const MatrixXd& values, const std::string& set, const char* what) {
  for (Index r = 0; r < values.rows(); ++r) {
    for (Index c = 0; c < values.cols(); ++c) {
      if (std::isfinite(values(r, c))) continue;
      throw InputError(fmt::format(
          "{} samples: {} in row {}, column {} is {}; leave out samples with numbers that are not finite",
          set, what, r, c, values(r, c)));
    }
  }
}

void checkWeights(const Samples& samples, const std::string& set) {
  const VectorXd& weights = samples.weights;
  if (weights.size() == 0) return;
  if (weights.size() != samples.targets.size()) {
    throw InputError(fmt::format("{} samples: {} weights, but {} targets; give one weight a row, or none",
                                 set, weights.size(), samples.targets.size()));
  }
  checkFinite(weights, set, "the weight");
  if (weights.minCoeff() >= 0.0 && weights.maxCoeff() > 0.0) return;
  throw InputError(fmt::format("{} samples: weights from {} to {}; give none below 0, and not 0 alone", set,
                               weights.minCoeff(), weights.maxCoeff()));
}

void checkSets(const Samples& training, const Samples& validation) {
  checkSamples(training, "training");
  if (training.targets.size() == 0)
    throw InputError("training samples: there are none; give at least one grasp");
  if (validation.targets.size() == 0) return;
  checkSamples(validation, "validation");
  if (validation.inputs.cols() == training.inputs.cols()) return;
  throw InputError(
      fmt::format("validation samples: {} features, but the training samples have {}; give both the same",
                  validation.inputs.cols(), training.inputs.cols()));
}

Network untrained(const Samples& training, const LevenbergMarquardtOptions& options, int start) {
  Network network;
  network.input = {training.inputs.colwise().minCoeff(), training.inputs.colwise().maxCoeff()};
  network.output = {VectorXd::Constant(1, training.targets.minCoeff()),
                    VectorXd::Constant(1, training.targets.maxCoeff())};
  network.layers = firstLayers(training.inputs.cols(), options.hidden, options.seed, start);
  return network;
}

void checkSize(const Network& network) {
  network.validate();
  if (parameterCount(network) <= kMaxParameters) return;
  throw InputError(fmt::format(
      "a network of {} weights is too large to train by Levenberg-Marquardt; use fewer hidden nodes, for "
      "at most {} weights",
      parameterCount(network), kMaxParameters));
}

double decisiveError(const TrainingReport& report) {
  const auto& errors = report.validation_mse.empty() ? report.training_mse : report.validation_mse;
  return errors[static_cast<std::size_t>(report.best_epoch)];
}

}  // namespace

void LevenbergMarquardtOptions::validate() const {
  requireOption(hidden.size() < Network::kMaxLayers, "hidden", hidden.size(), "at most 7 layers");
  for (const int nodes : hidden)
    requireOption(nodes >= 1 && nodes <= Network::kMaxNodes, "hidden", nodes, "1 to 1024 nodes a layer");
  requireOption(max_epochs >= 0 && max_epochs <= 1'000'000, "max_epochs", max_epochs, "0 to 1000000");
  requireOption(max_validation_failures >= 1, "max_validation_failures", max_validation_failures,
                "at least 1");
  requireOption(mu > 0.0 && mu <= mu_max, "mu", mu, "above 0 and at most mu_max");
  requireOption(mu_decrease > 0.0 && mu_decrease < 1.0, "mu_decrease", mu_decrease, "between 0 and 1");
  requireOption(mu_increase > 1.0 && std::isfinite(mu_increase), "mu_increase", mu_increase, "above 1");
  requireOption(std::isfinite(mu_max), "mu_max", mu_max, "finite");
  requireOption(min_gradient >= 0.0, "min_gradient", min_gradient, "at least 0");
  requireOption(starts >= 1 && starts <= 1000, "starts", starts, "1 to 1000");
}

Trained train(const Samples& training, const Samples& validation, const LevenbergMarquardtOptions& options,
              const StopToken& stop) {
  const auto begin = std::chrono::steady_clock::now();
  options.validate();
  checkSets(training, validation);
  Network network = untrained(training, options, 0);
  checkSize(network);
  const NormalisedSamples training_set = normalised(training, network);
  const NormalisedSamples validation_set =
      validation.targets.size() > 0 ? normalised(validation, network) : NormalisedSamples{};
  const Problem problem{training_set, validation_set, options, stop};
  std::optional<Trained> best;
  for (int start = 0; start < options.starts; ++start) {
    network.layers = firstLayers(network.inputs(), options.hidden, options.seed, start);
    Trained trained = Descent(problem, network).run();
    trained.report.best_start = start;
    if (!best || decisiveError(trained.report) < decisiveError(best->report)) best = std::move(trained);
  }
  best->report.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return *best;
}

void checkSamples(const Samples& samples, const std::string& set) {
  if (samples.inputs.rows() != samples.targets.size()) {
    throw InputError(fmt::format("{} samples: {} rows of inputs, but {} targets; give one target a row", set,
                                 samples.inputs.rows(), samples.targets.size()));
  }
  if (samples.inputs.cols() < 1 || samples.inputs.cols() > Network::kMaxNodes) {
    throw InputError(
        fmt::format("{} samples: {} features; give 1 to {}", set, samples.inputs.cols(), Network::kMaxNodes));
  }
  checkFinite(samples.inputs, set, "the input");
  checkFinite(samples.targets, set, "the target");
  checkWeights(samples, set);
}

Samples selectRows(const Samples& samples, const std::vector<Index>& rows) {
  Samples selected{samples.inputs(rows, Eigen::all), samples.targets(rows)};
  if (samples.weights.size() > 0) selected.weights = samples.weights(rows);
  return selected;
}

ResidualsAndJacobian residualsAndJacobian(const Network& network, const Samples& samples) {
  const NormalisedSamples set = normalised(samples, network);
  const Linearisation all = linearise(network, set.inputs, set.targets);
  return {all.residuals, all.jacobian.leftCols(parameterCount(network))};
}

VectorXd parameters(const Network& network) {
  VectorXd result(parameterCount(network));
  Index at = 0;
  for (const Layer& layer : network.layers) {
    for (Index o = 0; o < layer.weights.rows(); ++o) {
      result.segment(at, layer.weights.cols()) = layer.weights.row(o).transpose();
      at += layer.weights.cols();
      result[at++] = layer.bias[o];
    }
  }
  return result;
}

void setParameters(Network& network, const VectorXd& parameters) {
  assert(parameters.size() == parameterCount(network));
  Index at = 0;
  for (Layer& layer : network.layers) {
    for (Index o = 0; o < layer.weights.rows(); ++o) {
      layer.weights.row(o) = parameters.segment(at, layer.weights.cols()).transpose();
      at += layer.weights.cols();
      layer.bias[o] = parameters[at++];
    }
  }
}

}  // namespace boxgrasp
