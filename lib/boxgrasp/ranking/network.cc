#include "boxgrasp/ranking/network.h"

#include <cassert>

#include "boxgrasp/base/error.h"
#include "boxgrasp/ranking/activation.h"

namespace boxgrasp {
namespace {

using Eigen::Index;

constexpr double kClamp = 1.5;

// Halves first, so that no finite range overflows.
VectorXd centers(const Normalisation& n) { return 0.5 * n.min + 0.5 * n.max; }
VectorXd halves(const Normalisation& n) { return 0.5 * n.max - 0.5 * n.min; }

// Sums in the order of the inputs for every sample alike, whatever the number of samples.
MatrixXd layerSums(const Layer& layer, const MatrixXd& inputs) {
  MatrixXd sums(inputs.rows(), layer.weights.rows());
  for (Index o = 0; o < sums.cols(); ++o) {
    sums.col(o).setConstant(layer.bias[o]);
    for (Index i = 0; i < inputs.cols(); ++i) sums.col(o) += layer.weights(o, i) * inputs.col(i);
  }
  return sums;
}

void require(bool holds, const std::string& where, const std::string& what) {
  if (!holds) throw InputError(fmt::format("network: {} {}; train the network again", where, what));
}

void checkRanges(const Normalisation& normalisation, Index size, const std::string& where) {
  require(normalisation.min.size() == size && normalisation.max.size() == size, where,
          fmt::format("has {} minima and {} maxima, but must have {} of each", normalisation.min.size(),
                      normalisation.max.size(), size));
  require(normalisation.min.allFinite() && normalisation.max.allFinite(), where,
          "has a number that is not finite");
  require((normalisation.min.array() <= normalisation.max.array()).all(), where,
          "has a minimum above its maximum");
}

void checkLayer(const Layer& layer, Index inputs, const std::string& where) {
  require(layer.weights.cols() == inputs, where,
          fmt::format("takes {} inputs, but is given {}", layer.weights.cols(), inputs));
  require(layer.weights.rows() >= 1 && layer.weights.rows() <= Network::kMaxNodes, where,
          fmt::format("has {} nodes, but must have 1 to {}", layer.weights.rows(), Network::kMaxNodes));
  require(layer.bias.size() == layer.weights.rows(), where,
          fmt::format("has {} biases for {} nodes", layer.bias.size(), layer.weights.rows()));
  require(layer.weights.allFinite() && layer.bias.allFinite(), where, "has a number that is not finite");
}

}  // namespace

VectorXd Normalisation::apply(const VectorXd& x) const { return applyRows(x.transpose()).transpose(); }

VectorXd Normalisation::invert(const VectorXd& y) const { return invertRows(y.transpose()).transpose(); }

MatrixXd Normalisation::applyRows(const MatrixXd& x) const {
  assert(x.cols() == min.size());
  const VectorXd center = centers(*this), half = halves(*this);
  MatrixXd result(x.rows(), x.cols());
  for (Index i = 0; i < x.cols(); ++i) {
    if (half[i] > 0.0) {
      result.col(i) = (x.col(i).array() - center[i]) / half[i];
    } else {
      result.col(i).setZero();
    }
  }
  return result;
}

MatrixXd Normalisation::invertRows(const MatrixXd& y) const {
  assert(y.cols() == min.size());
  return ((y * halves(*this).asDiagonal()).rowwise() + centers(*this).transpose()).eval();
}

int Network::inputs() const { return static_cast<int>(input.min.size()); }

void Network::validate() const {
  require(inputs() >= 1 && inputs() <= kMaxNodes, "input",
          fmt::format("has {} features, but must have 1 to {}", inputs(), kMaxNodes));
  checkRanges(input, inputs(), "input");
  checkRanges(output, 1, "output");
  require(!layers.empty() && layers.size() <= kMaxLayers, "layers",
          fmt::format("are {}, but must be 1 to {}", layers.size(), kMaxLayers));
  Index width = inputs();
  for (std::size_t l = 0; l < layers.size(); ++l) {
    checkLayer(layers[l], width, fmt::format("layers[{}]", l));
    width = layers[l].weights.rows();
  }
  require(width == 1, "the last layer", fmt::format("has {} nodes, but must have 1", width));
}

double score(const Network& network, const VectorXd& measures) {
  return scores(network, measures.transpose())[0];
}

VectorXd scores(const Network& network, const MatrixXd& measures) {
  return network.output.invertRows(activations(network, normalisedInputs(network, measures)).back());
}

MatrixXd normalisedInputs(const Network& network, const MatrixXd& measures) {
  const auto clamp = [](double x) { return x > kClamp ? kClamp : (x < -kClamp ? -kClamp : x); };
  return network.input.applyRows(measures).unaryExpr(clamp);
}

std::vector<MatrixXd> activations(const Network& network, const MatrixXd& normalised_inputs) {
  std::vector<MatrixXd> result;
  result.reserve(network.layers.size() + 1);
  result.push_back(normalised_inputs);
  for (std::size_t l = 0; l < network.layers.size(); ++l) {
    result.push_back(layerSums(network.layers[l], result.back()));
    if (l + 1 < network.layers.size()) {
      tanhInPlace(result.back().data(), static_cast<std::size_t>(result.back().size()));
    }
  }
  return result;
}

}  // namespace boxgrasp
