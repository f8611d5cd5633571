// Laws of judging rankings: perfect, reversed and random ones, and what probabilities are worth.
#include "boxgrasp/training/ranking_verdict.h"

#include <gtest/gtest.h>

#include "boxgrasp/base/random.h"
#include "boxgrasp/planning/features.h"

namespace boxgrasp {
namespace {

using Eigen::Index;

GraspList randomList(const std::string& object, double scale, Index n, std::mt19937_64& random) {
  GraspList list{.key = {object, scale},
                 .measures = MatrixXd(2 * n, std::ssize(measureNames())),
                 .rows = {},
                 .success = VectorXd(n),
                 .held = VectorXd(n),
                 .hold = VectorXd(n),
                 .constellation = {},
                 .places = {}};
  for (double& value : list.measures.reshaped()) value = uniform(random);
  for (Index i = 0; i < n; ++i) {
    list.rows.push_back(2 * i);
    list.success[i] = uniform(random, 0.0, 2.0);
    list.held[i] = uniform(random) < 0.6;
    list.hold[i] = list.held[i];
  }
  return list;
}

std::vector<GraspList> randomLists() {
  std::mt19937_64 random(1);
  std::vector<GraspList> lists;
  for (const char* object : {"a", "b", "c"}) {
    for (const double scale : {1.0, 1.5}) lists.push_back(randomList(object, scale, 40, random));
  }
  return lists;
}

VectorXd targets(const std::vector<GraspList>& lists, LearningTarget target) {
  return samplesOf(lists, {}, target).samples.targets;
}

// Told apart by where they are.
std::vector<GraspPlace> places(std::size_t n) {
  std::vector<GraspPlace> result;
  for (std::size_t i = 0; i < n; ++i)
    result.push_back({{static_cast<double>(i), 0, 0}, Vector3d::UnitZ(), Vector3d::UnitX()});
  return result;
}

TEST(Judge, APerfectRankingReachesTheWholeSpanAndItsReverseNothing) {
  const std::vector<GraspList> lists = randomLists();
  const VectorXd s = targets(lists, LearningTarget::success);
  const RankingVerdict best = judge("best", lists, s), worst = judge("worst", lists, -s);
  EXPECT_NEAR(best.fraction, 1.0, 1e-12);
  EXPECT_NEAR(best.list_fraction, 1.0, 1e-12);
  EXPECT_NEAR(worst.fraction, 0.0, 1e-12);
  EXPECT_NEAR(best.s_net, -worst.s_net, 1e-12);
  EXPECT_NEAR(best.best_tenth - best.worst_tenth, best.s_net, 1e-12);
}

TEST(Judge, RankingByWhatHoldsPutsWhatHoldsFirst) {
  const std::vector<GraspList> lists = randomLists();
  const VectorXd hold = targets(lists, LearningTarget::hold);
  const RankingVerdict best = judge("held", lists, hold), worst = judge("lost", lists, -hold);
  EXPECT_EQ(best.top_held, 1.0);
  EXPECT_EQ(best.any_of_five_held, 1.0);
  EXPECT_NEAR(best.hold_fraction, 1.0, 1e-12);
  EXPECT_EQ(worst.top_held, 0.0);
  EXPECT_EQ(worst.any_of_five_held, 0.0);
}

TEST(Judge, ChanceReachesHalfTheSpanAndTheShareThatIsHeld) {
  const std::vector<GraspList> lists = randomLists();
  const RankingVerdict chance = judgeChance(lists, 2000, 1);
  EXPECT_NEAR(chance.fraction, 0.5, 0.02);
  EXPECT_NEAR(chance.top_held, targets(lists, LearningTarget::hold).mean(), 0.02);
  EXPECT_GT(chance.deviation, 0.0);
}

TEST(Judge, MeansAreOverTheRepeats) {
  const std::vector<GraspList> lists = randomLists();
  const VectorXd s = targets(lists, LearningTarget::success);
  MatrixXd scores(s.size(), 2);
  scores << s, -s;
  const RankingVerdict verdict = judge("both", lists, scores);
  EXPECT_NEAR(verdict.fraction, 0.5, 1e-12);
  EXPECT_NEAR(verdict.deviation, std::sqrt(0.5), 1e-12) << "sample deviation of 0 and 1";
  EXPECT_NEAR(verdict.objects[0].success.fraction, 0.5, 1e-12);
}

TEST(JudgeMeasures, FindTheOneThatIsTheLabelInItsDirection) {
  std::vector<GraspList> lists = randomLists();
  for (GraspList& list : lists) {
    for (std::size_t i = 0; i < list.rows.size(); ++i)
      list.measures(list.rows[i], 4) = -list.success[static_cast<Index>(i)];
  }
  const std::vector<RankingVerdict> measures = judgeMeasures(lists);
  EXPECT_EQ(measures.front().ranking, "q5, small");
  EXPECT_NEAR(measures.front().fraction, 1.0, 1e-12);
  EXPECT_EQ(measures.size(), measureNames().size());
}

TEST(JudgeMeasures, ListsOfFewGraspsCountInNoMeanOverLists) {
  std::mt19937_64 random(2);
  std::vector<GraspList> lists = randomLists();
  const VectorXd s = targets(lists, LearningTarget::success);
  const double before = judge("", lists, s.array().sin()).list_fraction;
  lists.push_back(randomList("d", 1.0, 5, random));
  const VectorXd more = targets(lists, LearningTarget::success);
  EXPECT_EQ(judge("", lists, more.array().sin()).list_fraction, before);
}

TEST(SamplesOf, TakeTheLabelledRowsAndTheTarget) {
  const std::vector<GraspList> lists = randomLists();
  const GroupedSamples both = samplesOf(lists, {"q1", "rank(q1)"}, LearningTarget::both);
  EXPECT_EQ(both.objects.size(), 240u);
  EXPECT_EQ(both.samples.inputs(41, 0), lists[1].measures(2, 0)) << "the second grasp of the second list";
  EXPECT_EQ(both.samples.inputs(41, 1), networkInputs({"rank(q1)"}, lists[1].measures)(2, 0))
      << "places count all hypotheses, labelled or not";
  EXPECT_EQ(both.samples.targets[41], lists[1].success[1] * lists[1].hold[1]);
  EXPECT_NE(dataHash(both), dataHash(samplesOf(lists, {"q1", "rank(q1)"}, LearningTarget::hold)));
}

TEST(GraspLists, KeepWhatWasTriedAsPlannedAndCountAllThatHeld) {
  const auto label = [](int perturbation, TrialOutcome outcome, double epsilon) {
    GraspLabel result;
    result.perturbation = perturbation;
    result.outcome = outcome;
    result.epsilon = result.nu = epsilon;
    return result;
  };
  const auto labelled = [](int index, std::vector<GraspLabel> labels) {
    LabelledHypothesis result;
    result.hypothesis.index = index;
    result.labels = std::move(labels);
    return result;
  };
  const HypothesisMeasures measures{MatrixXd::Zero(9, std::ssize(measureNames())), {}, places(9)};
  const std::vector<GraspList> lists = graspLists(
      {{{"a", 1.0},
        measures,
        {labelled(2, {label(0, TrialOutcome::held, 0.2), label(1, TrialOutcome::lost_in_lift, 0.2)}),
         labelled(4, {label(1, TrialOutcome::held, 0.9)})}},
       {{"a", 2.0}, measures, {labelled(7, {label(0, TrialOutcome::lost_in_shake, 0.4)})}}});
  ASSERT_EQ(lists[0].rows, std::vector<Index>{2}) << "4 was not tried as planned";
  EXPECT_EQ(lists[0].held[0], 1.0);
  EXPECT_EQ(lists[0].hold[0], 0.5);
  EXPECT_DOUBLE_EQ(lists[0].success[0], 0.5) << "over the greatest of the object in all sizes";
  EXPECT_DOUBLE_EQ(lists[1].success[0], 2.0);
  EXPECT_EQ(lists[1].places.front().contacts.x(), 7.0) << "the place of the grasp that was tried";
}

TEST(Remembered, AreWhatTheNetworksMisjudgedOnOtherObjects) {
  std::vector<GraspList> lists = randomLists();
  for (GraspList& list : lists) list.places = places(list.rows.size());
  const VectorXd target = targets(lists, LearningTarget::success);
  const VectorXd foretold = target.array() - 0.25;
  const std::vector<Recollection> others = recollectionsWithout("b", remembered(lists, target, foretold));
  ASSERT_EQ(others.size(), 4u) << "two sizes of a and of c";
  for (const Recollection& other : others) {
    EXPECT_EQ(other.places.size(), 40u);
    EXPECT_TRUE(other.surprises.isConstant(0.25)) << other.surprises.transpose();
  }
}

TEST(Remembered, AreChosenEvenlyWhereTheyAreMany) {
  std::mt19937_64 random(5);
  GraspList list = randomList("a", 1.0, 3000, random);
  list.places = places(list.rows.size());
  const VectorXd target = targets({list}, LearningTarget::success);
  const std::vector<Recollection> all =
      recollectionsWithout("", remembered({list}, target, VectorXd::Zero(3000)));
  ASSERT_EQ(all.front().places.size(), Recollection::kMaxGrasps);
  EXPECT_NEAR(all.front().places.back().contacts.x(), 3000, 4);
  EXPECT_NEAR(all.front().surprises[512], target[512 * 3000 / 1024], 1e-4);
}

TEST(Reliability, OfTrueProbabilitiesLiesOnTheDiagonal) {
  std::mt19937_64 random(3);
  VectorXd said(40'000), happened(40'000);
  for (Index i = 0; i < said.size(); ++i) {
    said[i] = uniform(random);
    happened[i] = uniform(random) < said[i];
  }
  const Reliability reliability = reliabilityOf(said, happened);
  for (const Reliability::Bin& bin : reliability.bins) EXPECT_NEAR(bin.said, bin.happened, 0.03);
  EXPECT_NEAR(reliability.brier, 1.0 / 6.0, 0.01) << "the mean of p (1 - p)";
  EXPECT_NEAR(reliability.base_brier, 0.25, 0.01);
}

TEST(Reliability, TakesZeroAndOneIntoItsOuterBins) {
  const Reliability reliability = reliabilityOf(VectorXd{{0.0, 1.0, 1.0}}, VectorXd{{0.0, 1.0, 1.0}}, 4);
  EXPECT_EQ(reliability.bins[0].grasps, 1);
  EXPECT_EQ(reliability.bins[3].grasps, 2);
  EXPECT_EQ(reliability.brier, 0.0);
}

}  // namespace
}  // namespace boxgrasp
