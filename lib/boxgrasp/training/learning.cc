#include "boxgrasp/training/learning.h"

#include <Eigen/LU>
#include <cmath>
#include <map>
#include <mutex>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/parallel.h"
#include "boxgrasp/base/random.h"

namespace boxgrasp {
namespace {

using Eigen::Index;

// --- calibration

constexpr int kMaxNewtonSteps = 100;
constexpr double kRidge = 1e-6;  // keeps the slope bounded where the scores part the outcomes perfectly

// Of the weighted cross entropy with scores of mean 0 and deviation 1, by slope and offset.
struct CrossEntropy {
  double value = 0.0;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  Eigen::Matrix2d curvature = Eigen::Matrix2d::Zero();
};

CrossEntropy crossEntropy(const Eigen::Vector2d& at, const VectorXd& scores, const VectorXd& outcomes,
                          const VectorXd& weights) {
  CrossEntropy sum;
  for (Index i = 0; i < scores.size(); ++i) {
    const Eigen::Vector2d x(scores[i], 1.0);
    const double t = at.dot(x), p = 1.0 / (1.0 + std::exp(-t));
    sum.value += weights[i] * (std::max(t, 0.0) + std::log1p(std::exp(-std::abs(t))) - outcomes[i] * t);
    sum.gradient += weights[i] * (p - outcomes[i]) * x;
    sum.curvature += weights[i] * p * (1.0 - p) * x * x.transpose();
  }
  sum.value += 0.5 * kRidge * at.squaredNorm();
  sum.gradient += kRidge * at;
  sum.curvature += kRidge * Eigen::Matrix2d::Identity();
  return sum;
}

// Newton's method, each step halved until it helps: the cross entropy is convex.
Eigen::Vector2d leastCrossEntropy(const VectorXd& scores, const VectorXd& outcomes, const VectorXd& weights) {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  for (int i = 0; i < kMaxNewtonSteps; ++i) {
    const CrossEntropy here = crossEntropy(at, scores, outcomes, weights);
    Eigen::Vector2d step = here.curvature.inverse() * here.gradient;
    while (step.norm() > 1e-12 && crossEntropy(at - step, scores, outcomes, weights).value > here.value)
      step /= 2.0;
    at -= step;
    if (step.norm() < 1e-10) break;
  }
  return at;
}

// --- learning

struct Object {
  std::string name;
  std::vector<Index> rows;
};

std::vector<Object> objectsOf(const GroupedSamples& data) {
  checkSamples(data.samples, "learning");
  if (static_cast<Index>(data.objects.size()) != data.samples.targets.size()) {
    throw InputError(fmt::format("learning: {} targets and {} object names; give one name a grasp",
                                 data.samples.targets.size(), data.objects.size()));
  }
  std::map<std::string, std::vector<Index>> rows;
  for (std::size_t i = 0; i < data.objects.size(); ++i)
    rows[data.objects[i]].push_back(static_cast<Index>(i));
  if (rows.size() < 2) {
    throw InputError(fmt::format(
        "learning: grasps of {} object(s); give those of at least 2: one to learn from, one to stop by",
        rows.size()));
  }
  std::vector<Object> result;
  for (auto& [name, indices] : rows) result.push_back({name, std::move(indices)});
  return result;
}

std::vector<std::size_t> shuffled(std::size_t n, std::mt19937_64& random) {
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = i;
  for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[uniformIndex(random, i)]);
  return order;
}

// What one network is trained with.
struct Turn {
  std::size_t left_out = 0;  // the object to stop by
  std::uint64_t seed = 0;
};

std::vector<Turn> turns(std::size_t objects, const LearningOptions& options) {
  std::mt19937_64 random(options.seed);
  const std::vector<std::size_t> order = shuffled(objects, random);
  std::vector<Turn> result;
  for (int i = 0; i < options.networks; ++i)
    result.push_back({order[static_cast<std::size_t>(i) % objects], random()});
  return result;
}

std::vector<Index> allBut(const std::vector<Object>& objects, std::size_t left_out) {
  std::vector<Index> rows;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (i != left_out) rows.insert(rows.end(), objects[i].rows.begin(), objects[i].rows.end());
  }
  return rows;
}

Calibration calibrationOf(const std::vector<Network>& networks, const std::vector<Samples>& left_out) {
  std::vector<double> values, outcomes, weights;
  for (std::size_t i = 0; i < networks.size(); ++i) {
    for (Index row = 0; row < left_out[i].targets.size(); ++row) {
      values.push_back(score(networks[i], left_out[i].inputs.row(row)));
      outcomes.push_back(left_out[i].targets[row]);
      weights.push_back(left_out[i].weights.size() > 0 ? left_out[i].weights[row] : 1.0);
    }
  }
  const auto vector = [](const std::vector<double>& list) {
    return VectorXd(VectorXd::Map(list.data(), static_cast<Index>(list.size())));
  };
  return fitCalibration(vector(values), vector(outcomes), vector(weights));
}

void checkProbabilities(const VectorXd& outcomes) {
  if (outcomes.size() > 0 && outcomes.minCoeff() >= 0.0 && outcomes.maxCoeff() <= 1.0) return;
  throw InputError(
      fmt::format("calibration: {} outcomes, which must be probabilities from 0 to 1; turn "
                  "calibration off for other targets",
                  outcomes.size()));
}

}  // namespace

void LearningOptions::validate() const {
  training.validate();
  requireOption(networks >= 1 && networks <= Ensemble::kMaxNetworks, "networks", networks, "1 to 64");
  requireOption(threads >= 0, "threads", threads, "at least 0");
}

Calibration fitCalibration(const VectorXd& scores, const VectorXd& outcomes, const VectorXd& weights) {
  checkProbabilities(outcomes);
  const VectorXd shares =
      weights.size() > 0
          ? VectorXd(weights / weights.sum())
          : VectorXd(VectorXd::Constant(scores.size(), 1.0 / static_cast<double>(scores.size())));
  const double mean = shares.dot(scores);
  const double deviation = std::sqrt(shares.dot((scores.array() - mean).square().matrix()));
  if (!(deviation > 0.0)) throw InputError("calibration: all scores are the same; train with other inputs");
  const Eigen::Vector2d best = leastCrossEntropy((scores.array() - mean) / deviation, outcomes, shares);
  const Calibration result{best[0] / deviation, best[1] - best[0] * mean / deviation};
  if (best[0] > 1e-9 && std::isfinite(result.slope) && std::isfinite(result.offset)) return result;
  throw InputError(
      "calibration: the scores do not rise with the outcomes on objects left out; label more objects, or "
      "turn "
      "calibration off");
}

Learnt learnNetworks(const GroupedSamples& data, const LearningOptions& options,
                     const std::function<void(std::size_t, std::size_t)>& progress, const StopToken& stop) {
  options.validate();
  const std::vector<Object> objects = objectsOf(data);
  if (options.calibrate) checkProbabilities(data.samples.targets);
  const std::vector<Turn> plan = turns(objects.size(), options);
  Learnt learnt;
  learnt.ensemble.networks.resize(plan.size());
  learnt.trainings.resize(plan.size());
  for (const Turn& turn : plan) learnt.stopped_by.push_back(objects[turn.left_out].name);
  std::vector<Samples> left_out(plan.size());
  std::mutex mutex;
  std::size_t done = 0;
  parallelFor(plan.size(), options.threads, [&](std::size_t i) {
    LevenbergMarquardtOptions training = options.training;
    training.seed = plan[i].seed;
    left_out[i] = selectRows(data.samples, objects[plan[i].left_out].rows);
    Trained trained =
        train(selectRows(data.samples, allBut(objects, plan[i].left_out)), left_out[i], training, stop);
    learnt.ensemble.networks[i] = std::move(trained.network);
    learnt.trainings[i] = std::move(trained.report);
    const std::lock_guard lock(mutex);
    if (progress) progress(++done, plan.size());
  });
  if (options.calibrate) learnt.ensemble.calibration = calibrationOf(learnt.ensemble.networks, left_out);
  return learnt;
}

Ensemble learn(const GroupedSamples& data, const LearningOptions& options,
               const std::function<void(std::size_t, std::size_t)>& progress, const StopToken& stop) {
  return learnNetworks(data, options, progress, stop).ensemble;
}

}  // namespace boxgrasp
