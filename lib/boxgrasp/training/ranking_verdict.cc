#include "boxgrasp/training/ranking_verdict.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "boxgrasp/base/random.h"
#include "boxgrasp/planning/features.h"

namespace boxgrasp {
namespace {

using Eigen::Index;

constexpr Index kLeastGrasps = 10;  // of a list: with fewer, a tenth is not one grasp

// A mean of what is a number.
class Mean {
 public:
  void add(double value) {
    if (std::isnan(value)) return;
    sum_ += value;
    ++n_;
  }
  double value() const { return n_ ? sum_ / n_ : NAN; }

 private:
  double sum_ = 0.0;
  int n_ = 0;
};

struct Rows {
  std::vector<double> scores, success;
};

VectorXd vectorOf(const std::vector<double>& values) {
  return VectorXd::Map(values.data(), static_cast<Index>(values.size()));
}

// The best-ranked first; equal scores keep their order.
std::vector<Index> order(const VectorXd& scores) {
  std::vector<Index> indices(static_cast<std::size_t>(scores.size()));
  std::iota(indices.begin(), indices.end(), Index{0});
  std::ranges::stable_sort(indices, [&](Index a, Index b) { return scores[a] > scores[b]; });
  return indices;
}

void judgeLists(const std::vector<GraspList>& lists, const VectorXd& scores, RankingVerdict& verdict) {
  Mean fraction, hold_fraction, top_held, top_hold, any_of_five;
  Index begin = 0;
  for (const GraspList& list : lists) {
    const Index n = std::ssize(list.rows);
    const VectorXd own = scores.segment(begin, n);
    begin += n;
    if (n < kLeastGrasps) continue;
    const std::vector<Index> first = order(own);
    fraction.add(rankingSuccess(own, list.success).fraction);
    hold_fraction.add(rankingSuccess(own, list.hold).fraction);
    top_held.add(list.held[first[0]]);
    top_hold.add(list.hold[first[0]]);
    any_of_five.add(list.held(std::vector<Index>(first.begin(), first.begin() + 5)).maxCoeff());
  }
  verdict.list_fraction = fraction.value();
  verdict.hold_fraction = hold_fraction.value();
  verdict.top_held = top_held.value();
  verdict.top_hold = top_hold.value();
  verdict.any_of_five_held = any_of_five.value();
}

void judgeObjects(const std::vector<GraspList>& lists, const VectorXd& scores, RankingVerdict& verdict) {
  std::map<std::string, Rows> objects;
  Index row = 0;
  for (const GraspList& list : lists) {
    Rows& object = objects[list.key.object];
    object.success.insert(object.success.end(), list.success.begin(), list.success.end());
    for (std::size_t i = 0; i < list.rows.size(); ++i) object.scores.push_back(scores[row++]);
  }
  Mean s_net, fraction, best, worst;
  for (const auto& [name, rows] : objects) {
    if (rows.scores.size() < 2) continue;
    const RankingSuccess success = rankingSuccess(vectorOf(rows.scores), vectorOf(rows.success));
    verdict.objects.push_back({name, std::ssize(rows.scores), success});
    s_net.add(success.value);
    fraction.add(success.fraction);
    best.add(success.mean_best_tenth);
    worst.add(success.mean_worst_tenth);
  }
  verdict.s_net = s_net.value();
  verdict.fraction = fraction.value();
  verdict.best_tenth = best.value();
  verdict.worst_tenth = worst.value();
}

RankingVerdict judgeOnce(const std::vector<GraspList>& lists, const VectorXd& scores) {
  RankingVerdict verdict;
  judgeObjects(lists, scores, verdict);
  judgeLists(lists, scores, verdict);
  return verdict;
}

constexpr double RankingVerdict::*kMeans[] = {
    &RankingVerdict::s_net,       &RankingVerdict::fraction,      &RankingVerdict::best_tenth,
    &RankingVerdict::worst_tenth, &RankingVerdict::list_fraction, &RankingVerdict::hold_fraction,
    &RankingVerdict::top_held,    &RankingVerdict::top_hold,      &RankingVerdict::any_of_five_held};
constexpr double RankingSuccess::*kObjectMeans[] = {&RankingSuccess::value, &RankingSuccess::fraction,
                                                    &RankingSuccess::mean_best_tenth,
                                                    &RankingSuccess::mean_worst_tenth};

template <class T>
double meanOf(const std::vector<RankingVerdict>& verdicts, const T& value) {
  Mean mean;
  for (const RankingVerdict& verdict : verdicts) mean.add(value(verdict));
  return mean.value();
}

RankingVerdict meanVerdict(const std::string& ranking, const std::vector<RankingVerdict>& verdicts) {
  RankingVerdict mean = verdicts.front();
  mean.ranking = ranking;
  for (const auto field : kMeans)
    mean.*field = meanOf(verdicts, [&](const RankingVerdict& one) { return one.*field; });
  for (std::size_t i = 0; i < mean.objects.size(); ++i) {
    for (const auto field : kObjectMeans)
      mean.objects[i].success.*field =
          meanOf(verdicts, [&](const RankingVerdict& one) { return one.objects[i].success.*field; });
  }
  const double squares =
      meanOf(verdicts, [&](const RankingVerdict& one) { return std::pow(one.fraction - mean.fraction, 2); });
  const auto n = static_cast<double>(verdicts.size());
  mean.deviation = n > 1 ? std::sqrt(squares * n / (n - 1)) : 0.0;
  return mean;
}

// The measures of the labelled grasps.
MatrixXd stackedMeasures(const std::vector<GraspList>& lists) {
  return samplesOf(lists, measureNames(), LearningTarget::success).samples.inputs;
}

}  // namespace

RankingVerdict judge(const std::string& ranking, const std::vector<GraspList>& lists,
                     const MatrixXd& scores) {
  std::vector<RankingVerdict> verdicts;
  for (Index repeat = 0; repeat < scores.cols(); ++repeat)
    verdicts.push_back(judgeOnce(lists, scores.col(repeat)));
  return meanVerdict(ranking, verdicts);
}

RankingVerdict judgeChance(const std::vector<GraspList>& lists, int repeats, std::uint64_t seed) {
  Index n = 0;
  for (const GraspList& list : lists) n += std::ssize(list.rows);
  std::mt19937_64 random(seed);
  MatrixXd scores(n, repeats);
  for (double& score : scores.reshaped()) score = uniform(random);
  return judge("random", lists, scores);
}

std::vector<RankingVerdict> judgeMeasures(const std::vector<GraspList>& lists) {
  const MatrixXd measures = stackedMeasures(lists);
  const std::vector<std::string> names = measureNames();
  std::vector<RankingVerdict> verdicts;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const VectorXd values = measures.col(static_cast<Index>(i));
    RankingVerdict large = judge(names[i] + ", large", lists, values);
    RankingVerdict small = judge(names[i] + ", small", lists, -values);
    verdicts.push_back(small.fraction > large.fraction ? std::move(small) : std::move(large));
  }
  std::ranges::stable_sort(verdicts, std::ranges::greater{}, &RankingVerdict::fraction);
  return verdicts;
}

Reliability reliabilityOf(const VectorXd& probabilities, const VectorXd& outcomes, int bins) {
  Reliability result;
  std::vector<Mean> said(static_cast<std::size_t>(bins)), happened(said.size());
  result.bins.resize(said.size());
  for (Index i = 0; i < probabilities.size(); ++i) {
    const auto bin =
        static_cast<std::size_t>(std::clamp(static_cast<int>(probabilities[i] * bins), 0, bins - 1));
    said[bin].add(probabilities[i]);
    happened[bin].add(outcomes[i]);
    ++result.bins[bin].grasps;
  }
  for (std::size_t bin = 0; bin < said.size(); ++bin) {
    result.bins[bin].said = said[bin].value();
    result.bins[bin].happened = happened[bin].value();
  }
  result.brier = (probabilities - outcomes).squaredNorm() / static_cast<double>(outcomes.size());
  result.base_brier = (outcomes.array() - outcomes.mean()).square().mean();
  return result;
}

}  // namespace boxgrasp
