#include "boxgrasp/training/gate.h"

#include <gtest/gtest.h>

#include <numeric>

#include "boxgrasp/base/random.h"
#include "boxgrasp/planning/features.h"
#include "boxgrasp/training/learning.h"
#include "error_of.h"

namespace boxgrasp {
namespace {

// A world in which a grasp is good where q1 is large and q9 small, which the simulator sees with some noise,
// and in which better grasps succeed more often.
const std::vector<std::string> kFeatures{"q1", "q9", "epsilon"};

Eigen::Index column(const std::string& measure) {
  const auto names = measureNames();
  return std::ranges::find(names, measure) - names.begin();
}

double worth(const MatrixXd& measures, Eigen::Index row) {
  return measures(row, column("q1")) - measures(row, column("q9"));
}

GraspList listOf(const std::string& object, std::uint64_t seed, double noise = 0.1) {
  constexpr Eigen::Index kGrasps = 60;
  std::mt19937_64 random(seed);
  GraspList list;
  list.key.object = object;
  list.measures.resize(kGrasps, std::ssize(measureNames()));
  for (double& x : list.measures.reshaped()) x = uniform(random, 0.0, 1.0);
  list.rows.resize(kGrasps);
  std::iota(list.rows.begin(), list.rows.end(), 0);
  list.success.resize(kGrasps);
  for (Eigen::Index i = 0; i < kGrasps; ++i)
    list.success[i] = 1 + worth(list.measures, i) + noise * normal(random);
  list.held = list.hold = VectorXd::Ones(kGrasps);
  return list;
}

std::vector<GraspList> listsOf(int objects, std::uint64_t seed, double noise = 0.1) {
  std::vector<GraspList> lists;
  for (int i = 0; i < objects; ++i) lists.push_back(listOf("object " + std::to_string(i), seed + i, noise));
  return lists;
}

// Reports on grasps of unknown objects; a robot that lies says the opposite of what happened.
std::vector<ReportedGrasp> reportsOf(const std::string& robot, int count, bool lies, std::uint64_t seed) {
  const GraspList list = listOf("reported", seed);
  const MatrixXd inputs = networkInputs(kFeatures, list.measures);
  std::vector<ReportedGrasp> reports;
  std::mt19937_64 chance(seed + 1000);
  for (int i = 0; i < count; ++i) {
    const Eigen::Index row = i % list.measures.rows();
    reports.push_back({robot, robot + std::to_string(i), inputs.row(row).transpose(),
                       (uniform(chance) < 1 / (1 + std::exp(-4 * worth(list.measures, row)))) != lies});
  }
  return reports;
}

std::vector<ReportedGrasp> operator+(std::vector<ReportedGrasp> a, const std::vector<ReportedGrasp>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Model modelOf(const std::vector<ReportedGrasp>& reports, double noise = 0.1) {
  LearningOptions options;
  options.training.hidden = {3};
  options.networks = 2;
  const GroupedSamples simulated = samplesOf(listsOf(6, 100, noise), kFeatures, LearningTarget::success);
  Model model;
  model.features = kFeatures;
  model.ensemble = learn(joined(simulated, reports), options);
  return model;
}

const Model& honest() {
  static const Model model = modelOf({});
  return model;
}

HeldOut heldOutData(std::vector<ReportedGrasp> reports = {}) {
  return {listsOf(3, 900), LearningTarget::success, std::move(reports)};
}

TEST(Gate, LetsAModelPassThatIsAsGood) {
  const GateVerdict verdict = judgeCandidate(honest(), honest(), heldOutData());
  EXPECT_TRUE(verdict.passed) << verdict.words;
  EXPECT_EQ(verdict.comparisons[0].candidate, verdict.comparisons[0].in_service);
  EXPECT_GT(verdict.comparisons[0].candidate, 0.9) << "the honest model should know this world";
}

TEST(Gate, LetsTruthfulReportsIn) {
  // A simulator that knows little leaves something to learn.
  constexpr double kPoor = 3.0;
  const auto truth =
      reportsOf("a", 100, false, 1) + reportsOf("b", 100, false, 2) + reportsOf("c", 100, false, 3);
  const GateVerdict verdict =
      judgeCandidate(modelOf(truth, kPoor), modelOf({}, kPoor), heldOutData(reportsOf("d", 60, false, 4)));
  EXPECT_TRUE(verdict.passed) << verdict.words;
  for (const Comparison& comparison : verdict.comparisons)
    EXPECT_GT(comparison.candidate, comparison.in_service) << verdict.words;
}

TEST(Gate, HoldsWhenEveryRobotLies) {
  std::vector<ReportedGrasp> flood;
  for (int robot = 0; robot < 10; ++robot)
    flood = flood + reportsOf("liar " + std::to_string(robot), 500, true, 10 + robot);
  const Model candidate = modelOf(flood);
  // The reports that are kept out are lies too, and on them the candidate does better.
  const GateVerdict verdict =
      judgeCandidate(candidate, honest(), heldOutData(reportsOf("liar 1", 60, true, 77)));
  EXPECT_FALSE(verdict.passed) << verdict.words;
  EXPECT_TRUE(verdict.comparisons[1].passed) << "by the lies alone it would pass: " << verdict.words;
}

TEST(Gate, RefusesWhatIsWorseOnReports) {
  Model reversed = honest();
  for (Network& network : reversed.ensemble.networks) network.layers.back().weights *= -1;
  HeldOut data = heldOutData(reportsOf("a", 60, false, 5));
  const GateVerdict verdict = judgeCandidate(reversed, honest(), data);
  EXPECT_FALSE(verdict.comparisons[0].passed) << verdict.words;
  EXPECT_FALSE(verdict.comparisons[1].passed) << verdict.words;
  EXPECT_FALSE(verdict.passed);
}

TEST(Gate, DoesNotPassWithoutObjectsToJudgeBy) {
  const GateVerdict verdict =
      judgeCandidate(honest(), honest(), {{}, LearningTarget::success, reportsOf("a", 60, false, 5)});
  EXPECT_FALSE(verdict.passed) << verdict.words;
}

TEST(OutcomeLearning, NoRobotOutweighsTheOthers) {
  const GroupedSamples simulated = samplesOf(listsOf(6, 100), kFeatures, LearningTarget::success);
  const auto reports = reportsOf("loud", 1000, true, 1) + reportsOf("b", 30, false, 2) +
                       reportsOf("c", 30, false, 3) + reportsOf("d", 30, false, 4);
  const GroupedSamples all = joined(simulated, reports);
  const Eigen::Index n = simulated.samples.targets.size();
  double loud = 0, sum = 0;
  for (Eigen::Index i = n; i < all.samples.targets.size(); ++i) {
    sum += all.samples.weights[i];
    if (all.objects[static_cast<std::size_t>(i)] == "robot loud") loud += all.samples.weights[i];
  }
  EXPECT_NEAR(loud / sum, OutcomeWeighing{}.max_robot_share, 1e-9);
}

TEST(OutcomeLearning, ReportsHaveAtMostTheirShare) {
  const GroupedSamples simulated = samplesOf(listsOf(6, 100), kFeatures, LearningTarget::success);
  std::vector<ReportedGrasp> reports;
  for (int robot = 0; robot < 5; ++robot)
    reports = reports + reportsOf(std::to_string(robot), 2000, false, robot);
  const GroupedSamples all = joined(simulated, reports);
  const Eigen::Index n = simulated.samples.targets.size();
  EXPECT_EQ(all.samples.weights.head(n), VectorXd::Ones(n));
  EXPECT_NEAR(all.samples.weights.tail(all.samples.weights.size() - n).sum(), n, 1e-6);
}

TEST(OutcomeLearning, FewReportsCountAsTheySay) {
  const GroupedSamples simulated = samplesOf(listsOf(6, 100), kFeatures, LearningTarget::success);
  const auto reports =
      reportsOf("a", 2, false, 1) + reportsOf("b", 2, false, 2) + reportsOf("c", 2, false, 3);
  const VectorXd weights = joined(simulated, reports).samples.weights;
  EXPECT_TRUE(weights.tail(6).isApproxToConstant(OutcomeWeighing{}.report_weight))
      << weights.tail(6).transpose();
  EXPECT_EQ(joined(simulated, {}).samples.targets, simulated.samples.targets);
}

TEST(OutcomeLearning, RefusesReportsOfOtherInputs) {
  const GroupedSamples simulated = samplesOf(listsOf(2, 1), kFeatures, LearningTarget::success);
  const std::string error = test::errorOf([&] { joined(simulated, {{"a", "r", VectorXd::Zero(5), true}}); });
  EXPECT_NE(error.find("5 inputs, not 3"), std::string::npos) << error;
}

TEST(HeldOut, IsAboutOneInSoManyAndTheSameAlways) {
  int count = 0;
  for (int i = 0; i < 5000; ++i) {
    const std::string name = "request " + std::to_string(i);
    count += heldOut(name, 5);
    ASSERT_EQ(heldOut(name, 5), heldOut(name, 5));
  }
  EXPECT_NEAR(count, 1000, 120);
}

}  // namespace
}  // namespace boxgrasp
