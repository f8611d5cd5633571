#include "boxgrasp/registry/canary.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/planning/features.h"

namespace boxgrasp {
namespace {

constexpr int kPlausible = 60;
constexpr int kEnough = 5;         // grasps until a time is believed
constexpr double kMostTimes = 10;  // as long as the model before
constexpr double kHarmless_s = 50e-6;

// What the measures of real grasps reach, in their units.
constexpr QualityMeasures kLargest{5e-3, 1.0, 1.0, 0.1, 1.5, 0.1, 0.05, 1e-3, 0.1};

double scoreOf(const Model& model, const CanaryGrasp& grasp) {
  return scores(model.ensemble, networkInputs(model.features, grasp.quality, grasp.size_m).transpose())[0];
}

// The score, and its time where that is less than least_s.
double timedScore(const Model& model, const CanaryGrasp& grasp, double& least_s) {
  const auto start = std::chrono::steady_clock::now();
  const double score = scoreOf(model, grasp);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  least_s = std::min(least_s, time.count());
  return score;
}

void checkScore(const Model& model, double score, std::size_t grasp) {
  if (!std::isfinite(score))
    throw InputError(fmt::format("the model scores canary grasp {} with {}; train it again", grasp, score));
  if (model.ensemble.calibration && (score < 0 || score > 1))
    throw InputError(
        fmt::format("the model scores canary grasp {} with {}, but its calibrated scores must lie in [0, 1]; "
                    "train it again",
                    grasp, score));
}

}  // namespace

std::vector<CanaryGrasp> canaryGrasps() {
  std::mt19937_64 random(1);
  std::vector<CanaryGrasp> grasps(kPlausible);
  for (CanaryGrasp& grasp : grasps) {
    grasp.size_m = uniform(random, 0.02, 0.3);
    for (std::size_t q = 0; q < grasp.quality.size(); ++q) grasp.quality[q] = kLargest[q] * uniform(random);
  }
  for (const double extreme : {0.0, 1e3, -1e3, 1e9}) {
    CanaryGrasp grasp{{}, 0.1};
    grasp.quality.fill(extreme);
    grasps.push_back(grasp);
  }
  return grasps;
}

double graspSeconds(const Model& model) {
  double least_s = std::numeric_limits<double>::infinity();
  for (const CanaryGrasp& grasp : canaryGrasps()) timedScore(model, grasp, least_s);
  return least_s;
}

void runCanary(const Model& model, double most_s) {
  model.ensemble.validate();
  requireOption(model.ensemble.inputs() == static_cast<int>(model.features.size()),
                "the model's number of inputs", model.ensemble.inputs(), "that of its features");
  const std::vector<CanaryGrasp> grasps = canaryGrasps();
  std::vector<double> all;
  double least_s = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < grasps.size(); ++i) {
    all.push_back(timedScore(model, grasps[i], least_s));
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
