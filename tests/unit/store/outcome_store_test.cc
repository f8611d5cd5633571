#include "boxgrasp/store/outcome_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <fstream>
#include <limits>
#include <set>
#include <thread>

#include "error_of.h"
#include "experience_examples.h"

namespace boxgrasp {
namespace {

using test::errorOf;
using test::TemporaryFolder;
using ::testing::HasSubstr;

const AnswerOrigin kOrigin{"0badc0de", "q1 q2", "barrett", "cup"};

RememberedAnswer answerTo(const std::string& request_id, std::size_t grasps = 2) {
  RememberedAnswer answer{request_id, 7, kOrigin, {}};
  for (std::size_t i = 0; i < grasps; ++i)
    answer.grasps.push_back({{0.25 * static_cast<double>(i), 1.0 / 3.0}, 0.5});
  return answer;
}

RobotOutcome outcomeOf(const std::string& request_id, int grasp_index, bool succeeded,
                       const std::string& robot = "robot") {
  RobotOutcome outcome;
  outcome.request_id = request_id;
  outcome.grasp_index = grasp_index;
  outcome.robot = robot;
  outcome.succeeded = succeeded;
  return outcome;
}

class OutcomeStoreTest : public ::testing::Test {
 protected:
  OutcomeStore open(int max_answers = 100) const {
    return OutcomeStore(folder_ / "outcomes.db", {.max_answers = max_answers});
  }

  TemporaryFolder folder_;
};

TEST_F(OutcomeStoreTest, KeepsOutcomesWithWhatWasPredictedToTheBit) {
  RememberedAnswer answer = answerTo("plan");
  answer.grasps[1] = {{-0.0, std::numeric_limits<double>::denorm_min(), 1.0 / 3.0, HUGE_VAL}, NAN};
  RobotOutcome outcome = outcomeOf("plan", 1, true);
  outcome.what = "it said: 'held' \xe2\x9c\x93\nand \"so\"";
  outcome.forces_n = {1e-300, -0.0, 2.5};
  outcome.utime = std::numeric_limits<std::int64_t>::max();
  outcome.weight = 0.1;
  {
    OutcomeStore store = open();
    store.rememberAnswer(answer);
    ASSERT_EQ(store.addOutcome(outcome), OutcomeReceipt::stored);
  }
  const auto outcomes = open().outcomesAfter(0);
  ASSERT_EQ(outcomes.size(), 1u);
  const StoredOutcome& read = outcomes[0];
  EXPECT_GT(read.id, 0);
  EXPECT_EQ(read.outcome.request_id, "plan");
  EXPECT_EQ(read.outcome.grasp_index, 1);
  EXPECT_EQ(read.outcome.robot, "robot");
  EXPECT_TRUE(read.outcome.succeeded);
  EXPECT_EQ(read.outcome.what, outcome.what);
  EXPECT_EQ(read.outcome.utime, outcome.utime);
  EXPECT_EQ(read.outcome.weight, outcome.weight);
  ASSERT_EQ(read.outcome.forces_n.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(read.outcome.forces_n[i]),
              std::bit_cast<std::uint64_t>(outcome.forces_n[i]));
  }
  EXPECT_EQ(read.origin.model_version, kOrigin.model_version);
  EXPECT_EQ(read.origin.features, kOrigin.features);
  EXPECT_EQ(read.origin.hand, kOrigin.hand);
  EXPECT_EQ(read.origin.object, kOrigin.object);
  ASSERT_EQ(read.grasp.inputs.size(), 4u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(read.grasp.inputs[i]),
              std::bit_cast<std::uint64_t>(answer.grasps[1].inputs[i]));
  }
  EXPECT_TRUE(std::isnan(read.grasp.score));
}

TEST_F(OutcomeStoreTest, CountsEachRobotsWordOnGraspOnce) {
  OutcomeStore store = open();
  store.rememberAnswer(answerTo("plan"));
  EXPECT_EQ(store.addOutcome(outcomeOf("plan", 0, true)), OutcomeReceipt::stored);
  EXPECT_EQ(store.addOutcome(outcomeOf("plan", 0, true)), OutcomeReceipt::duplicate);
  EXPECT_EQ(store.addOutcome(outcomeOf("plan", 0, false)), OutcomeReceipt::conflicting);
  EXPECT_EQ(store.addOutcome(outcomeOf("plan", 0, false, "another")), OutcomeReceipt::stored);
  EXPECT_EQ(store.addOutcome(outcomeOf("plan", 1, false)), OutcomeReceipt::stored);
  const auto outcomes = store.outcomesAfter(0);
  ASSERT_EQ(outcomes.size(), 3u);
  EXPECT_TRUE(outcomes[0].outcome.succeeded) << "the first word stays";
}

TEST_F(OutcomeStoreTest, TakesNoOutcomeOfWhatItDidNotAnswer) {
  OutcomeStore store = open();
  store.rememberAnswer(answerTo("plan"));
  EXPECT_EQ(store.addOutcome(outcomeOf("another", 0, true)), OutcomeReceipt::unknown_request);
  EXPECT_EQ(store.addOutcome(outcomeOf("plan", 2, true)), OutcomeReceipt::unknown_grasp);
  EXPECT_EQ(store.addOutcome(outcomeOf("plan", -1, true)), OutcomeReceipt::unknown_grasp);
  EXPECT_EQ(store.countAfter(0), 0);
}

TEST_F(OutcomeStoreTest, NumbersOutcomesInTheirOrder) {
  OutcomeStore store = open();
  store.rememberAnswer(answerTo("plan", 5));
  for (int i = 0; i < 5; ++i) store.addOutcome(outcomeOf("plan", i, i % 2 == 0));
  const auto all = store.outcomesAfter(0);
  ASSERT_EQ(all.size(), 5u);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].outcome.grasp_index, static_cast<int>(i));
    EXPECT_EQ(store.countAfter(all[i].id), static_cast<std::int64_t>(all.size() - 1 - i));
    EXPECT_EQ(store.outcomesAfter(all[i].id).size(), all.size() - 1 - i);
  }
}

TEST_F(OutcomeStoreTest, KeepsWhatWasPredictedWhenTheAnswerIsReplaced) {
  OutcomeStore store = open();
  store.rememberAnswer(answerTo("plan"));
  store.addOutcome(outcomeOf("plan", 0, true));
  RememberedAnswer later = answerTo("plan");
  later.origin.model_version = "c0ffee00";
  store.rememberAnswer(later);
  EXPECT_EQ(store.answers(), 1);
  store.addOutcome(outcomeOf("plan", 1, true));
  const auto outcomes = store.outcomesAfter(0);
  ASSERT_EQ(outcomes.size(), 2u);
  EXPECT_EQ(outcomes[0].origin.model_version, "0badc0de");
  EXPECT_EQ(outcomes[1].origin.model_version, "c0ffee00");
}

// Among the older half those without outcomes go first.
TEST_F(OutcomeStoreTest, ForgetsOldAnswersButNoOutcomes) {
  constexpr int kMost = 10;
  OutcomeStore store = open(kMost);
  for (int i = 0; i < kMost; ++i) {
    store.rememberAnswer(answerTo("plan " + std::to_string(i)));
    if (i < 2) store.addOutcome(outcomeOf("plan " + std::to_string(i), 0, true));
  }
  for (int i = kMost; i < kMost + 2; ++i) store.rememberAnswer(answerTo("plan " + std::to_string(i)));
  EXPECT_EQ(store.answers(), kMost);
  const auto known = [&](int i) {
    return store.addOutcome(outcomeOf("plan " + std::to_string(i), 1, true)) !=
           OutcomeReceipt::unknown_request;
  };
  std::set<int> forgotten;
  for (int i = 0; i < kMost + 2; ++i) {
    if (!known(i)) forgotten.insert(i);
  }
  EXPECT_EQ(forgotten, (std::set<int>{2, 3})) << "the oldest two without outcomes";
  for (int i = 0; i < 5 * kMost; ++i) store.rememberAnswer(answerTo("later " + std::to_string(i)));
  EXPECT_EQ(store.answers(), kMost);
  EXPECT_EQ(store.countAfter(0), 2 + kMost) << "outcomes stay when their answers go";
}

TEST_F(OutcomeStoreTest, RefusesTextsAndForcesWithoutEnd) {
  OutcomeStore store = open();
  store.rememberAnswer(answerTo("plan"));
  RobotOutcome wordy = outcomeOf("plan", 0, true), strong = wordy;
  wordy.what = std::string(OutcomeStore::kMaxTextBytes + 1, 'x');
  strong.forces_n.resize(OutcomeStore::kMaxForces + 1);
  EXPECT_THAT(errorOf([&] { store.addOutcome(wordy); }), HasSubstr("'what' is a text of 4097 bytes"));
  EXPECT_THAT(errorOf([&] { store.addOutcome(strong); }), HasSubstr("'forces_n' has 65 values"));
  RememberedAnswer answer = answerTo("plan 2");
  answer.origin.object = wordy.what;
  EXPECT_THAT(errorOf([&] { store.rememberAnswer(answer); }), HasSubstr("'object'"));
  EXPECT_EQ(store.answers(), 1);
  EXPECT_EQ(store.countAfter(0), 0);
}

TEST_F(OutcomeStoreTest, KeepsTheWorkersNotes) {
  {
    OutcomeStore store = open();
    EXPECT_FALSE(store.progress("learnt"));
    store.setProgress("learnt", "1");
    store.setProgress("learnt", "2");
    store.setProgress("tried", "");
  }
  EXPECT_EQ(open().progress("learnt"), "2");
  EXPECT_EQ(open().progress("tried"), "");
}

TEST_F(OutcomeStoreTest, RefusesFilesThatAreNoStoreAndLeavesThemAsTheyAre) {
  const auto file = folder_ / "outcomes.db";
  const std::string text = "These are my notes on outcomes, and not a database of them.\n";
  std::ofstream(file) << std::string(200, '\n') << text;
  EXPECT_THAT(errorOf([&] { open(); }), HasSubstr("outcomes.db"));
  std::ifstream stream(file);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), std::string(200, '\n') + text);
}

TEST_F(OutcomeStoreTest, ServesSeveralAtOnceWithoutLosingAny) {
  constexpr int kThreads = 4, kGrasps = 25;
  open().rememberAnswer(answerTo("plan", kGrasps));
  std::vector<std::jthread> robots;
  for (int robot = 0; robot < kThreads; ++robot) {
    robots.emplace_back([&, robot] {
      OutcomeStore store = open();
      for (int i = 0; i < kGrasps; ++i)
        store.addOutcome(outcomeOf("plan", i, true, "robot " + std::to_string(robot)));
    });
  }
  robots.clear();
  std::set<std::pair<std::string, int>> stored;
  std::set<std::int64_t> ids;
  for (const StoredOutcome& one : open().outcomesAfter(0)) {
    stored.emplace(one.outcome.robot, one.outcome.grasp_index);
    ids.insert(one.id);
  }
  EXPECT_EQ(stored.size(), std::size_t{kThreads * kGrasps});
  EXPECT_EQ(ids.size(), std::size_t{kThreads * kGrasps});
}

}  // namespace
}  // namespace boxgrasp
