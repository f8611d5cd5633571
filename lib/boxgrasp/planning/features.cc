#include "boxgrasp/planning/features.h"

#include <fmt/format.h>

#include <cmath>

#include "boxgrasp/base/error.h"

namespace boxgrasp {
namespace {

// The power of the size by which each measure grows with the object: areas 2, lengths 1, angles and ratios 0.
constexpr std::array<int, 9> kPowers{2, 0, 0, 1, 0, 1, 1, 2, 1};
constexpr std::array<std::string_view, 3> kSuffixes{"", "/L", "/L2"};

double value(const std::string& feature, const QualityMeasures& quality, double size_m) {
  if (feature.size() >= 2 && feature[0] == 'q' && feature[1] >= '1' && feature[1] <= '9') {
    const double measure = quality[static_cast<std::size_t>(feature[1] - '1')];
    for (std::size_t power = 0; power < kSuffixes.size(); ++power) {
      if (feature.substr(2) == kSuffixes[power])
        return measure / std::pow(size_m, static_cast<double>(power));
    }
  }
  throw InputError(fmt::format(
      "the model's feature '{}' is unknown: features are q1 to q9, each alone or followed by /L or /L2",
      feature));
}

}  // namespace

std::vector<std::string> rawFeatures() {
  std::vector<std::string> features;
  for (int q = 1; q <= 9; ++q) features.push_back(fmt::format("q{}", q));
  return features;
}

std::vector<std::string> relativeFeatures() {
  std::vector<std::string> features = rawFeatures();
  for (std::size_t i = 0; i < features.size(); ++i)
    features[i] += kSuffixes[static_cast<std::size_t>(kPowers[i])];
  return features;
}

double objectSize(const PlannedObject& object) { return object.tree.nodes.front().box.extents.norm() / 2; }

VectorXd networkInputs(const std::vector<std::string>& features, const QualityMeasures& quality,
                       double size_m) {
  VectorXd inputs(static_cast<Eigen::Index>(features.size()));
  for (std::size_t i = 0; i < features.size(); ++i)
    inputs[static_cast<Eigen::Index>(i)] = value(features[i], quality, size_m);
  return inputs;
}

}  // namespace boxgrasp
