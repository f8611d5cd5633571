#include "boxgrasp/training/levenberg_marquardt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "boxgrasp/training/normal_equations.h"
#include "error_of.h"
#include "synthetic_samples.h"

namespace boxgrasp {
namespace {

using test::errorOf;
using test::noSamples;
using test::sampled;
using ::testing::HasSubstr;

double meanSquaredErrorOf(const Network& network, const Samples& samples) {
  return (scores(network, samples.inputs) - samples.targets).squaredNorm() /
         static_cast<double>(samples.targets.size());
}

LevenbergMarquardtOptions withHidden(std::vector<int> hidden) {
  LevenbergMarquardtOptions options;
  options.hidden = std::move(hidden);
  return options;
}

// --- normal equations

TEST(NormalEquations, AreThePlainProducts) {
  std::mt19937_64 random(1);
  for (const Eigen::Index parameters : {1, 2, 7, 8, 9, 23, 89}) {
    NormalEquations equations(parameters);
    const MatrixXd jacobian = MatrixXd::NullaryExpr(150, parameters, [&] { return normal(random); });
    const VectorXd residuals = VectorXd::NullaryExpr(150, [&] { return normal(random); });
    for (const auto& [first, rows] : {std::pair{0, 64}, {64, 64}, {128, 21}, {149, 1}}) {
      NormalEquations::Block block = NormalEquations::Block::Zero(rows, NormalEquations::padded(parameters));
      block.leftCols(parameters) = jacobian.middleRows(first, rows);
      equations.add(block, residuals.segment(first, rows));
    }
    const MatrixXd difference = MatrixXd(equations.matrix()) - jacobian.transpose() * jacobian;
    EXPECT_LT(difference.triangularView<Eigen::Lower>().toDenseMatrix().norm(), 1e-10)
        << parameters << " parameters";
    EXPECT_LT((equations.vector() - jacobian.transpose() * residuals).norm(), 1e-11)
        << parameters << " parameters";
    EXPECT_NEAR(equations.squaredResiduals(), residuals.squaredNorm(), 1e-11);
  }
}

// --- Jacobian

// Central differences of the residuals by every parameter.
MatrixXd numericJacobian(Network network, const Samples& samples) {
  const VectorXd at = parameters(network);
  const double step = 1e-5;
  MatrixXd jacobian(samples.targets.size(), at.size());
  for (Eigen::Index p = 0; p < at.size(); ++p) {
    const auto residualsAt = [&](double x) {
      VectorXd moved = at;
      moved[p] = x;
      setParameters(network, moved);
      return residualsAndJacobian(network, samples).residuals;
    };
    jacobian.col(p) = (residualsAt(at[p] + step) - residualsAt(at[p] - step)) / (2.0 * step);
  }
  return jacobian;
}

TEST(Jacobian, AgreesWithNumericDerivatives) {
  const Samples samples = sampled(40, 5, 3, [](const VectorXd& x) { return x.sum(); });
  for (const std::vector<int>& hidden :
       std::vector<std::vector<int>>{{}, {1}, {8}, {4, 3}, {3, 4, 2}, {2, 2, 2, 2, 2, 2, 2}}) {
    LevenbergMarquardtOptions options = withHidden(hidden);
    options.max_epochs = 1;
    const Network network = train(samples, noSamples(5), options).network;
    const MatrixXd analytic = residualsAndJacobian(network, samples).jacobian;
    ASSERT_EQ(analytic.cols(), parameters(network).size());
    EXPECT_LT((analytic - numericJacobian(network, samples)).cwiseAbs().maxCoeff(), 1e-8)
        << hidden.size() << " hidden layers";
  }
}

TEST(Jacobian, ResidualsAreScoresMinusTargetsInNormalisedUnits) {
  const Samples samples = sampled(30, 3, 4, [](const VectorXd& x) { return 7.0 + 3.0 * x[0]; });
  const Network network = train(samples, noSamples(3)).network;
  const double half = 0.5 * (network.output.max[0] - network.output.min[0]);
  const VectorXd expected = (scores(network, samples.inputs) - samples.targets) / half;
  EXPECT_LT((residualsAndJacobian(network, samples).residuals - expected).norm(), 1e-12);
}

TEST(Parameters, SetWhatTheyGet) {
  const Samples samples = sampled(10, 4, 5, [](const VectorXd& x) { return x[1]; });
  Network network = train(samples, noSamples(4), withHidden({3, 2})).network;
  const VectorXd before = parameters(network);
  ASSERT_EQ(before.size(), 4 * 3 + 3 + 3 * 2 + 2 + 2 + 1);
  const VectorXd other = VectorXd::LinSpaced(before.size(), -1.0, 1.0);
  setParameters(network, other);
  EXPECT_EQ(parameters(network), other);
  EXPECT_EQ(network.layers[0].weights(0, 1), other[1]) << "a node's weights stand together";
  EXPECT_EQ(network.layers[0].bias[0], other[4]) << "and its bias follows them";
}

// --- learning

TEST(Train, LearnsExclusiveOr) {
  const Samples samples{(MatrixXd(4, 2) << 0, 0, 0, 1, 1, 0, 1, 1).finished(), Eigen::Vector4d(0, 1, 1, 0)};
  const Trained trained = train(samples, noSamples(2), withHidden({3}));
  EXPECT_LT(meanSquaredErrorOf(trained.network, samples), 1e-8) << trained.report.stop_reason;
}

TEST(Train, LearnsSineBetweenItsSamples) {
  const auto sine = [](const VectorXd& x) { return std::sin(2.5 * x[0]); };
  const Trained trained = train(sampled(200, 1, 6, sine), noSamples(1));
  EXPECT_LT(meanSquaredErrorOf(trained.network, sampled(500, 1, 7, sine)), 1e-5);
}

TEST(Train, RecoversALinearFunctionWithoutHiddenLayers) {
  const auto linear = [](const VectorXd& x) { return 3.0 * x[0] - 2.0 * x[1] + 5.0; };
  const Trained trained = train(sampled(50, 2, 8, linear), noSamples(2), withHidden({}));
  EXPECT_LT(meanSquaredErrorOf(trained.network, sampled(50, 2, 9, linear)), 1e-12);
}

// A network of the same size as the teacher reaches a small error on samples that it has not seen.
TEST(Train, LearnsWhatATeacherNetworkDoes) {
  const auto teacher = [](const VectorXd& x) {
    return std::tanh(1.5 * x[0] - x[1] + 0.2) + 0.5 * std::tanh(2.0 * x[2] + x[3]);
  };
  LevenbergMarquardtOptions options = withHidden({2});
  options.max_epochs = 300;
  options.starts = 5;
  const Trained trained = train(sampled(400, 4, 10, teacher), noSamples(4), options);
  EXPECT_LT(meanSquaredErrorOf(trained.network, sampled(400, 4, 11, teacher)), 1e-10)
      << trained.report.stop_reason;
}

TEST(Train, ErrorFallsWithEveryEpoch) {
  const Trained trained = train(test::noisy(300, 9, 12), noSamples(9));
  const auto& mse = trained.report.training_mse;
  ASSERT_GT(mse.size(), 5u);
  for (std::size_t e = 1; e < mse.size(); ++e) EXPECT_LT(mse[e], mse[e - 1]) << "epoch " << e;
  EXPECT_EQ(trained.report.best_epoch, static_cast<int>(mse.size()) - 1);
}

TEST(Train, ReportsTheErrorOfTheNetworkItReturns) {
  const Samples training = test::noisy(200, 4, 13), validation = test::noisy(80, 4, 14);
  const Trained trained = train(training, validation);
  const auto best = static_cast<std::size_t>(trained.report.best_epoch);
  const auto mse = [&](const Samples& s) {
    return residualsAndJacobian(trained.network, s).residuals.squaredNorm() /
           static_cast<double>(s.targets.size());
  };
  EXPECT_NEAR(trained.report.training_mse[best], mse(training), 1e-13);
  EXPECT_NEAR(trained.report.validation_mse[best], mse(validation), 1e-13);
  EXPECT_GE(trained.report.time_s, 0.0);
}

// --- early stopping

// Far more weights than noisy samples: without stopping, the network learns the noise.
TEST(Train, StopsBeforeItLearnsTheNoise) {
  const Samples training = test::noisy(60, 3, 15), validation = test::noisy(200, 3, 16),
                unseen = test::noisy(500, 3, 17);
  LevenbergMarquardtOptions options = withHidden({12});
  options.starts = 1;
  const Trained stopped = train(training, validation, options),
                unstopped = train(training, noSamples(3), options);
  EXPECT_EQ(stopped.report.stop_reason, "validation error stopped falling");
  EXPECT_LT(meanSquaredErrorOf(stopped.network, unseen), 0.5 * meanSquaredErrorOf(unstopped.network, unseen));
  const auto& errors = stopped.report.validation_mse;
  EXPECT_EQ(errors[static_cast<std::size_t>(stopped.report.best_epoch)],
            *std::min_element(errors.begin(), errors.end()));
  EXPECT_EQ(static_cast<int>(errors.size()) - 1 - stopped.report.best_epoch, options.max_validation_failures);
}

TEST(Train, KeepsTheBestOfItsStarts) {
  const Samples training = test::noisy(60, 3, 18), validation = test::noisy(60, 3, 19);
  const auto bestError = [&](int starts) {
    LevenbergMarquardtOptions options;
    options.starts = starts;
    const TrainingReport report = train(training, validation, options).report;
    EXPECT_LT(report.best_start, starts);
    return report.validation_mse[static_cast<std::size_t>(report.best_epoch)];
  };
  double before = bestError(1);
  for (int starts = 2; starts <= 6; ++starts) {
    const double now = bestError(starts);
    EXPECT_LE(now, before) << "with " << starts << " starts";
    before = now;
  }
}

// --- the same bits

TEST(Train, GivesTheSameBitsAgainAndOthersForAnotherSeed) {
  const Samples training = test::noisy(333, 9, 20), validation = test::noisy(50, 9, 21);
  LevenbergMarquardtOptions options;
  const VectorXd first = parameters(train(training, validation, options).network);
  EXPECT_EQ(parameters(train(training, validation, options).network), first);
  options.seed = std::uint64_t{1} << 40;
  EXPECT_NE(parameters(train(training, validation, options).network), first);
}

// --- edge cases

TEST(Train, IgnoresAConstantFeature) {
  Samples samples = sampled(100, 3, 22, [](const VectorXd& x) { return std::sin(x[0]) + x[2]; });
  samples.inputs.col(1).setConstant(42.0);
  const Network network = train(samples, noSamples(3)).network;
  EXPECT_LT(meanSquaredErrorOf(network, samples), 1e-5);
  VectorXd x = samples.inputs.row(0);
  const double before = score(network, x);
  x[1] = -1e6;
  EXPECT_EQ(score(network, x), before);
}

TEST(Train, LearnsAConstantTarget) {
  Samples samples = test::noisy(40, 3, 23);
  samples.targets.setConstant(0.7);
  EXPECT_EQ(score(train(samples, noSamples(3)).network, samples.inputs.row(5)), 0.7);
}

TEST(Train, LearnsASingleSample) {
  const Samples samples{MatrixXd::Constant(1, 9, 3.0), VectorXd::Constant(1, -2.0)};
  EXPECT_EQ(score(train(samples, noSamples(9)).network, samples.inputs.row(0)), -2.0);
}

TEST(Train, KeepsTheFirstWeightsInZeroEpochs) {
  LevenbergMarquardtOptions options;
  options.max_epochs = 0;
  const Trained trained = train(test::noisy(40, 3, 24), noSamples(3), options);
  EXPECT_EQ(trained.report.training_mse.size(), 1u);
  EXPECT_EQ(trained.report.best_epoch, 0);
}

// Nguyen and Widrow: all nodes' weights have the norm 0.7 nodes^(1/inputs); biases span as much.
TEST(Train, StartsFromNguyenAndWidrowsWeights) {
  LevenbergMarquardtOptions options;
  options.max_epochs = 0;
  const Layer layer = train(test::noisy(40, 9, 25), noSamples(9), options).network.layers[0];
  const double length = 0.7 * std::pow(8.0, 1.0 / 9.0);
  for (int o = 0; o < 8; ++o) EXPECT_NEAR(layer.weights.row(o).norm(), length, 1e-12) << "node " << o;
  EXPECT_NEAR(layer.bias.cwiseAbs().maxCoeff(), length, 1e-12);
}

TEST(Train, StopsWhenAsked) {
  EXPECT_THROW(train(test::noisy(40, 3, 26), noSamples(3), {}, StopToken(StopToken::Clock::now())), Stopped);
}

TEST(Train, RefusesBadSamplesByName) {
  const Samples good = test::noisy(40, 3, 27);
  Samples bad = good;
  bad.targets[17] = NAN;
  EXPECT_THAT(errorOf([&] { train(bad, noSamples(3)); }),
              HasSubstr("training samples: the target in row 17"));
  EXPECT_THAT(errorOf([&] { train(good, bad); }), HasSubstr("validation samples: the target in row 17"));
  bad = good;
  bad.inputs(4, 2) = INFINITY;
  EXPECT_THAT(errorOf([&] { train(bad, noSamples(3)); }), HasSubstr("the input in row 4, column 2 is inf"));
  bad = good;
  bad.targets.conservativeResize(39);
  EXPECT_THAT(errorOf([&] { train(bad, noSamples(3)); }), HasSubstr("40 rows of inputs, but 39 targets"));
  EXPECT_THAT(errorOf([&] { train(good, test::noisy(5, 4, 1)); }),
              HasSubstr("4 features, but the training samples have 3"));
  EXPECT_THAT(errorOf([&] { train(noSamples(3), good); }), HasSubstr("there are none"));
  EXPECT_THAT(errorOf([&] {
                train({MatrixXd(3, 0), Eigen::Vector3d(1, 2, 3)}, noSamples(0));
              }),
              HasSubstr("training samples: 0 features"));
}

TEST(Train, RefusesANetworkTooLargeForItsMethod) {
  EXPECT_THAT(errorOf([&] { train(test::noisy(5, 3, 28), noSamples(3), withHidden({1024})); }),
              HasSubstr("a network of 5121 weights is too large"));
}

TEST(Train, RefusesBadOptionsByName) {
  const auto error = [](const std::function<void(LevenbergMarquardtOptions&)>& change) {
    LevenbergMarquardtOptions options;
    change(options);
    return errorOf([&] { options.validate(); });
  };
  EXPECT_EQ(error([](auto&) {}), "accepted");
  EXPECT_THAT(error([](auto& o) { o.hidden = {8, 0}; }), HasSubstr("option 'hidden' is 0"));
  EXPECT_THAT(error([](auto& o) { o.hidden.assign(8, 1); }), HasSubstr("option 'hidden' is 8"));
  EXPECT_THAT(error([](auto& o) { o.max_epochs = -1; }), HasSubstr("'max_epochs' is -1"));
  EXPECT_THAT(error([](auto& o) { o.max_validation_failures = 0; }),
              HasSubstr("'max_validation_failures' is 0"));
  EXPECT_THAT(error([](auto& o) { o.mu = 0.0; }), HasSubstr("'mu' is 0"));
  EXPECT_THAT(error([](auto& o) { o.mu = NAN; }), HasSubstr("'mu' is nan"));
  EXPECT_THAT(error([](auto& o) { o.mu_decrease = 1.0; }), HasSubstr("'mu_decrease' is 1"));
  EXPECT_THAT(error([](auto& o) { o.mu_increase = 1.0; }), HasSubstr("'mu_increase' is 1"));
  EXPECT_THAT(error([](auto& o) { o.mu_max = INFINITY; }), HasSubstr("'mu_max' is inf"));
  EXPECT_THAT(error([](auto& o) { o.min_gradient = -1.0; }), HasSubstr("'min_gradient' is -1"));
  EXPECT_THAT(error([](auto& o) { o.starts = 0; }), HasSubstr("'starts' is 0"));
}

}  // namespace
}  // namespace boxgrasp
