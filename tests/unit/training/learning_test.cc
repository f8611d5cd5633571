#include "boxgrasp/training/learning.h"

#include <gtest/gtest.h>

#include "boxgrasp/base/error.h"
#include "synthetic_samples.h"

namespace boxgrasp {
namespace {

// Five objects; a grasp holds with probability 1 / (1 + exp(-4 x0)).
GroupedSamples coins(Eigen::Index n) {
  std::mt19937_64 random(7);
  GroupedSamples data;
  data.samples = test::sampled(n, 3, 3, [&](const VectorXd& x) {
    return uniform(random, 0.0, 1.0) < 1.0 / (1.0 + std::exp(-4.0 * x[0])) ? 1.0 : 0.0;
  });
  for (Eigen::Index i = 0; i < n; ++i) data.objects.push_back(fmt::format("object {}", i % 5));
  return data;
}

LearningOptions small() {
  LearningOptions options;
  options.training.hidden = {3};
  options.training.max_epochs = 15;
  options.networks = 3;
  options.calibrate = true;
  return options;
}

TEST(FitCalibration, FindsTheProbabilitiesThatMadeTheOutcomes) {
  const VectorXd scores = VectorXd::LinSpaced(101, -2.0, 3.0);
  const VectorXd outcomes = calibrated({1.7, -0.4}, scores);
  const Calibration found = fitCalibration(scores, outcomes);
  EXPECT_NEAR(found.slope, 1.7, 1e-4);
  EXPECT_NEAR(found.offset, -0.4, 1e-4);
}

TEST(FitCalibration, CountsARowOfWeightTwoAsTwoRows) {
  const VectorXd scores = (VectorXd(4) << 0.0, 1.0, 2.0, 3.0).finished();
  const VectorXd outcomes = (VectorXd(4) << 0.0, 1.0, 0.0, 1.0).finished();
  const VectorXd weights = (VectorXd(4) << 1.0, 1.0, 1.0, 2.0).finished();
  const VectorXd twice_scores = (VectorXd(5) << scores, 3.0).finished();
  const VectorXd twice_outcomes = (VectorXd(5) << outcomes, 1.0).finished();
  const Calibration weighted = fitCalibration(scores, outcomes, weights);
  const Calibration twice = fitCalibration(twice_scores, twice_outcomes);
  EXPECT_NEAR(weighted.slope, twice.slope, 1e-8);
  EXPECT_NEAR(weighted.offset, twice.offset, 1e-8);
}

TEST(FitCalibration, RefusesScoresThatFallWithTheOutcomesAndOutcomesThatAreNone) {
  const VectorXd scores = VectorXd::LinSpaced(9, 0.0, 1.0);
  EXPECT_THROW(fitCalibration(scores, (1.0 - scores.array()).matrix()), InputError);
  EXPECT_THROW(fitCalibration(scores, 2.0 * scores), InputError);
  EXPECT_THROW(fitCalibration(VectorXd::Ones(9), scores), InputError);
}

TEST(Learn, ScoresAreTheProbabilitiesThatMadeTheOutcomes) {
  const Ensemble ensemble = learn(coins(4000), small());
  const Samples asked =
      test::sampled(200, 3, 11, [](const VectorXd& x) { return 1.0 / (1.0 + std::exp(-4.0 * x[0])); });
  const VectorXd errors = scores(ensemble, asked.inputs) - asked.targets;
  EXPECT_LT(errors.cwiseAbs().mean(), 0.05) << "of the probability, mean over 200 new grasps";
}

TEST(Learn, DoesNotDependOnTheNumberOfThreads) {
  const GroupedSamples data = coins(300);
  LearningOptions options = small();
  options.threads = 1;
  const Ensemble one = learn(data, options);
  options.threads = 2;
  const Ensemble two = learn(data, options);
  EXPECT_EQ(scores(one, data.samples.inputs), scores(two, data.samples.inputs));
}

TEST(Learn, TellsItsProgressAndStops) {
  std::vector<std::size_t> told;
  learn(coins(300), small(), [&](std::size_t done, std::size_t total) {
    EXPECT_EQ(total, 3U);
    told.push_back(done);
  });
  EXPECT_EQ(told, (std::vector<std::size_t>{1, 2, 3}));
  const StopToken expired(StopToken::Clock::now());
  EXPECT_THROW(learn(coins(300), small(), {}, expired), Stopped);
}

TEST(Learn, RefusesASingleObjectAndTargetsThatAreNoProbabilities) {
  GroupedSamples data = coins(50);
  data.samples.targets[0] = 1.5;
  EXPECT_THROW(learn(data, small()), InputError);
  data = coins(50);
  data.objects.assign(50, "mug");
  EXPECT_THROW(learn(data, small()), InputError);
}

// Twice the same row is once the row with weight 2: the same error surface, so the same descent up to
// rounding.
TEST(Train, ARowOfWeightTwoCountsAsTwoRows) {
  Samples weighted = test::noisy(60, 3, 5);
  weighted.weights = VectorXd::Ones(60);
  weighted.weights.head(20).setConstant(2.0);
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < 60; ++i) rows.insert(rows.end(), i < 20 ? 2 : 1, i);
  Samples twice = selectRows(weighted, rows);
  twice.weights.resize(0);
  LevenbergMarquardtOptions options;
  options.hidden = {2};
  options.max_epochs = 5;
  options.starts = 1;
  const VectorXd a = scores(train(weighted, test::noSamples(3), options).network, weighted.inputs);
  const VectorXd b = scores(train(twice, test::noSamples(3), options).network, weighted.inputs);
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-8);
  weighted.weights.setOnes();
  const VectorXd c = scores(train(weighted, test::noSamples(3), options).network, weighted.inputs);
  EXPECT_GT((a - c).cwiseAbs().maxCoeff(), 1e-4) << "the weights must matter";
}

TEST(Train, RefusesWeightsThatAreNegativeZeroOrTooFew) {
  Samples samples = test::noisy(10, 3, 5);
  for (const VectorXd& weights :
       {VectorXd(VectorXd::Constant(10, -1.0)), VectorXd(VectorXd::Zero(10)), VectorXd(VectorXd::Ones(9))}) {
    samples.weights = weights;
    EXPECT_THROW(train(samples, test::noSamples(3)), InputError) << weights.transpose();
  }
}

}  // namespace
}  // namespace boxgrasp
