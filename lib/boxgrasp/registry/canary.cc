#include "boxgrasp/registry/canary.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/planning/features.h"

namespace boxgrasp {
namespace {

constexpr Eigen::Index kPlausible = 60;
constexpr double kExtremes[] = {0.0, 1e3, -1e3, 1e9};
constexpr int kEnough = 5;         // grasps until a time is believed
constexpr double kMostTimes = 10;  // as long as the model before
constexpr double kHarmless_s = 50e-6;

// What the measures of real grasps reach, in their units; of those that are not here, 1.
const std::map<std::string, double> kLargest{
    {"q1", 5e-3},         {"q4", 0.1},       {"q5", 1.5},          {"q6", 0.1},          {"q7", 0.05},
    {"q8", 1e-3},         {"q9", 0.1},       {"epsilon", 0.3},     {"nu", 0.1},          {"center", 0.1},
    {"center_off", 0.1},  {"span_min", 0.1}, {"span_max", 0.2},    {"spread_out", 0.05}, {"depth", 0.12},
    {"palm", 0.2},        {"spread", 3.1},   {"finger_bend", 2.4}, {"thumb_bend", 2.4},  {"thumb_angle", 0.4},
    {"focus_area", 5e-3}, {"level", 4.0}};

double largest(const std::string& measure) {
  const auto found = kLargest.find(measure);
  return found == kLargest.end() ? 1.0 : found->second;
}

// The score, and its time where that is less than least_s.
double timedScore(const Model& model, const Eigen::RowVectorXd& inputs, double& least_s) {
  const auto start = std::chrono::steady_clock::now();
  const double score = scores(model.ensemble, inputs)[0];
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  least_s = std::min(least_s, time.count());
  return score;
}

void checkScore(const Model& model, double score, Eigen::Index grasp) {
  if (!std::isfinite(score))
    throw InputError(fmt::format("the model scores canary grasp {} with {}; train it again", grasp, score));
  if (model.ensemble.calibration && (score < 0 || score > 1))
    throw InputError(
        fmt::format("the model scores canary grasp {} with {}, but its calibrated scores must lie in [0, 1]; "
                    "train it again",
                    grasp, score));
}

}  // namespace

MatrixXd canaryMeasures() {
  std::mt19937_64 random(1);
  const std::vector<std::string> names = measureNames();
  MatrixXd measures(kPlausible + std::ssize(kExtremes), std::ssize(names));
  for (Eigen::Index row = 0; row < kPlausible; ++row) {
    for (std::size_t i = 0; i < names.size(); ++i)
      measures(row, static_cast<Eigen::Index>(i)) =
          names[i] == "size" ? uniform(random, 0.02, 0.3) : largest(names[i]) * uniform(random);
  }
  for (std::size_t i = 0; i < std::size(kExtremes); ++i)
    measures.row(kPlausible + static_cast<Eigen::Index>(i)).setConstant(kExtremes[i]);
  const auto size = std::ranges::find(names, "size") - names.begin();
  measures.col(size).tail(std::size(kExtremes)).setConstant(0.1);
  return measures;
}

double graspSeconds(const Model& model) {
  double least_s = std::numeric_limits<double>::infinity();
  const MatrixXd inputs = networkInputs(model.features, canaryMeasures());
  for (Eigen::Index i = 0; i < inputs.rows(); ++i) timedScore(model, inputs.row(i), least_s);
  return least_s;
}

void runCanary(const Model& model, double most_s) {
  model.ensemble.validate();
  requireOption(model.ensemble.inputs() == static_cast<int>(model.features.size()),
                "the model's number of inputs", model.ensemble.inputs(), "that of its features");
  const MatrixXd inputs = networkInputs(model.features, canaryMeasures());
  std::vector<double> all;
  double least_s = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
    all.push_back(timedScore(model, inputs.row(i), least_s));
    checkScore(model, all.back(), i);
    if (i + 1 >= kEnough && least_s > most_s)
      throw InputError(
          fmt::format("the model takes {:.0f} us to score a grasp, but at most {:.0f} are allowed (the "
                      "larger of {:.0f} and "
                      "{:.0f} times what the model in service takes); train a smaller one",
                      1e6 * least_s, 1e6 * most_s, 1e6 * kHarmless_s, kMostTimes));
  }
  if (std::all_of(all.begin(), all.end(), [&](double score) { return score == all.front(); }))
    throw InputError(fmt::format(
        "the model gives every canary grasp the same score, {}, and so ranks nothing; train it again",
        all.front()));
}

double slowestAllowed(double old_s) { return std::max(kMostTimes * old_s, kHarmless_s); }

}  // namespace boxgrasp
