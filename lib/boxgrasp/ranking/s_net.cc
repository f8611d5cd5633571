#include "boxgrasp/ranking/s_net.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <numeric>
#include <vector>

namespace boxgrasp {
namespace {

using Eigen::VectorXd;

VectorXd inOrderOfFallingScore(const VectorXd& scores, const VectorXd& successes) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(scores.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return scores[a] > scores[b]; });
  return successes(order);
}

struct Tenths {
  double best, worst;
};

// Summed in the ranking's order.
Tenths meansOfTenths(const VectorXd& ranked) {
  const Eigen::Index tenth = std::max<Eigen::Index>(1, ranked.size() / 10);
  const auto mean = [&](Eigen::Index first) {
    return std::accumulate(ranked.data() + first, ranked.data() + first + tenth, 0.0) /
           static_cast<double>(tenth);
  };
  return {mean(0), mean(ranked.size() - tenth)};
}

}  // namespace

RankingSuccess rankingSuccess(const VectorXd& scores, const VectorXd& successes) {
  assert(scores.size() == successes.size() && scores.size() >= 2);
  assert(scores.allFinite() && successes.allFinite());
  const Tenths ranked = meansOfTenths(inOrderOfFallingScore(scores, successes));
  const Tenths perfect = meansOfTenths(inOrderOfFallingScore(successes, successes));
  RankingSuccess result;
  result.mean_best_tenth = ranked.best;
  result.mean_worst_tenth = ranked.worst;
  result.value = ranked.best - ranked.worst;
  result.ceiling = perfect.best - perfect.worst;
  result.floor = -result.ceiling;
  result.fraction = result.ceiling > 0.0 ? (result.value - result.floor) / (result.ceiling - result.floor)
                                         : std::numeric_limits<double>::quiet_NaN();
  return result;
}

}  // namespace boxgrasp
