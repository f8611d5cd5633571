#include "boxgrasp/ranking/s_net.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "boxgrasp/base/random.h"

namespace boxgrasp {
namespace {

using Eigen::VectorXd;

VectorXd randomVector(Eigen::Index n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  VectorXd v(n);
  for (double& x : v) x = uniform(random);
  return v;
}

// Eq. 7 word by word: the list in order of falling prediction, the first and the last 0.1 n of it.
double equation7(const VectorXd& scores, const VectorXd& successes) {
  std::vector<std::pair<double, double>> ranked;
  for (Eigen::Index i = 0; i < scores.size(); ++i) ranked.emplace_back(-scores[i], successes[i]);
  std::sort(ranked.begin(), ranked.end());
  const std::size_t n = ranked.size(), tenth = n / 10;
  double high = 0.0, low = 0.0;
  for (std::size_t i = 0; i < tenth; ++i) {
    high += ranked[i].second;
    low += ranked[n - tenth + i].second;
  }
  return (high - low) / static_cast<double>(tenth);
}

// 20 grasps: two are a tenth.
TEST(RankingSuccess, IsAsComputedByHand) {
  VectorXd scores(20), successes(20);
  for (int i = 0; i < 20; ++i) {
    scores[i] = i;
    successes[i] = 0.1 * i;
  }
  std::swap(successes[19], successes[0]);  // the best-ranked grasp fails, the worst-ranked succeeds
  const RankingSuccess result = rankingSuccess(scores, successes);
  EXPECT_NEAR(result.mean_best_tenth, (0.0 + 1.8) / 2, 1e-15);
  EXPECT_NEAR(result.mean_worst_tenth, (1.9 + 0.1) / 2, 1e-15);
  EXPECT_NEAR(result.value, -0.1, 1e-15);
  EXPECT_NEAR(result.ceiling, (1.9 + 1.8) / 2 - (0.0 + 0.1) / 2, 1e-15);
  EXPECT_NEAR(result.floor, -1.8, 1e-15);
  EXPECT_NEAR(result.fraction, 1.7 / 3.6, 1e-15);
}

TEST(RankingSuccess, FollowsEquation7ForRandomRankings) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto n = static_cast<Eigen::Index>(10 + 7 * seed);
    const VectorXd scores = randomVector(n, seed), successes = randomVector(n, seed + 1000);
    EXPECT_NEAR(rankingSuccess(scores, successes).value, equation7(scores, successes), 1e-12)
        << n << " grasps";
  }
}

TEST(RankingSuccess, OfAPerfectRankingIsTheCeilingAndOfItsReverseTheFloor) {
  for (const Eigen::Index n : {2, 3, 9, 10, 19, 100, 5951}) {
    const VectorXd successes = randomVector(n, 7);
    const RankingSuccess perfect = rankingSuccess(successes.array().exp().matrix(), successes);
    const RankingSuccess reverse = rankingSuccess(-successes, successes);
    EXPECT_EQ(perfect.value, perfect.ceiling) << n << " grasps";
    EXPECT_EQ(perfect.fraction, 1.0);
    EXPECT_NEAR(reverse.value, reverse.floor, 1e-15) << n << " grasps";
    EXPECT_NEAR(reverse.fraction, 0.0, 1e-15);
    EXPECT_EQ(perfect.floor, -perfect.ceiling);
  }
}

TEST(RankingSuccess, LiesBetweenFloorAndCeiling) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const RankingSuccess result = rankingSuccess(randomVector(37, seed), randomVector(37, seed + 500));
    EXPECT_LE(result.value, result.ceiling) << "seed " << seed;
    EXPECT_GE(result.value, result.floor) << "seed " << seed;
  }
}

TEST(RankingSuccess, DependsOnlyOnTheOrderOfTheScores) {
  const VectorXd scores = randomVector(50, 1), successes = randomVector(50, 2);
  EXPECT_EQ(rankingSuccess(scores, successes).value,
            rankingSuccess(scores.array().cube() * 100.0 - 5.0, successes).value);
}

TEST(RankingSuccess, OfAShuffledListIsTheSame) {
  const VectorXd scores = randomVector(64, 3), successes = randomVector(64, 4);
  std::vector<int> order(64);
  std::iota(order.begin(), order.end(), 0);
  std::mt19937_64 random(5);
  for (std::size_t i = 63; i > 0; --i) std::swap(order[i], order[uniformIndex(random, i + 1)]);
  EXPECT_EQ(rankingSuccess(scores, successes).value, rankingSuccess(scores(order), successes(order)).value);
}

TEST(RankingSuccess, KeepsTheOrderOfEqualScores) {
  const RankingSuccess result = rankingSuccess(VectorXd::Constant(3, 0.5), Eigen::Vector3d(0.2, 0.9, 0.6));
  EXPECT_NEAR(result.value, 0.2 - 0.6, 1e-15);
}

TEST(RankingSuccess, OfEqualSuccessesHasNoFraction) {
  const RankingSuccess result = rankingSuccess(randomVector(30, 1), VectorXd::Constant(30, 0.7));
  EXPECT_EQ(result.value, 0.0);
  EXPECT_TRUE(std::isnan(result.fraction));
}

}  // namespace
}  // namespace boxgrasp
