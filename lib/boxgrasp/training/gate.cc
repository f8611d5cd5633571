#include "boxgrasp/training/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "boxgrasp/base/error.h"
#include "boxgrasp/planning/features.h"
#include "boxgrasp/ranking/s_net.h"

namespace boxgrasp {
namespace {

constexpr std::size_t kFewest = 10;  // grasps in a list, of which a tenth is one

VectorXd scoresOn(const Model& model, const GraspList& list) {
  const VectorXd all = scores(model.ensemble, networkInputs(model.features, list.measures));
  VectorXd chosen(std::ssize(list.rows));
  for (Eigen::Index i = 0; i < chosen.size(); ++i) chosen[i] = all[list.rows[static_cast<std::size_t>(i)]];
  return chosen;
}

double meanFraction(const Model& model, const HeldOut& held_out, int& lists) {
  double sum = 0.0;
  lists = 0;
  for (const GraspList& list : held_out.lists) {
    if (list.rows.size() < kFewest) continue;
    const VectorXd targets = samplesOf({list}, {}, held_out.target).samples.targets;
    const double fraction = rankingSuccess(scoresOn(model, list), targets).fraction;
    if (std::isnan(fraction)) continue;
    sum += fraction;
    ++lists;
  }
  return sum / lists;
}

VectorXd scoresOf(const Model& model, const std::vector<const ReportedGrasp*>& reports) {
  MatrixXd inputs(std::ssize(reports), std::ssize(model.features));
  for (Eigen::Index i = 0; i < inputs.rows(); ++i)
    inputs.row(i) = reports[static_cast<std::size_t>(i)]->inputs.transpose();
  return scores(model.ensemble, inputs);
}

// How often a success outscores a failure; NaN where there are not both.
double outscoring(const VectorXd& scores, const std::vector<const ReportedGrasp*>& reports) {
  double won = 0.0, pairs = 0.0;
  for (Eigen::Index i = 0; i < scores.size(); ++i) {
    for (Eigen::Index j = 0; j < scores.size(); ++j) {
      const bool a = reports[static_cast<std::size_t>(i)]->succeeded,
                 b = reports[static_cast<std::size_t>(j)]->succeeded;
      if (!a || b) continue;
      pairs += 1.0;
      won += scores[i] > scores[j] ? 1.0 : scores[i] == scores[j] ? 0.5 : 0.0;
    }
  }
  return won / pairs;
}

double meanOutscoring(const Model& model, const std::vector<ReportedGrasp>& reports) {
  std::map<std::string, std::vector<const ReportedGrasp*>> by_robot;
  for (const ReportedGrasp& report : reports) by_robot[report.robot].push_back(&report);
  double sum = 0.0, robots = 0.0;
  for (const auto& [robot, own] : by_robot) {
    const double share = outscoring(scoresOf(model, own), own);
    if (std::isnan(share)) continue;
    sum += share;
    robots += 1.0;
  }
  return sum / robots;
}

Comparison byObjects(const Model& candidate, const Model& in_service, const HeldOut& held_out,
                     double tolerance) {
  Comparison result;
  result.by = "share of the span from the worst ranking to the perfect one, on objects kept out";
  result.candidate = meanFraction(candidate, held_out, result.cases);
  result.in_service = meanFraction(in_service, held_out, result.cases);
  result.judged = result.cases > 0;
  result.passed = result.judged && result.candidate >= result.in_service - tolerance;
  return result;
}

Comparison byReports(const Model& candidate, const Model& in_service, const HeldOut& held_out,
                     const GateOptions& options) {
  Comparison result;
  result.by = "share of pairs in which a reported success outscores a reported failure, on reports kept out";
  result.cases = static_cast<int>(held_out.reports.size());
  if (result.cases < options.min_reports || candidate.features != in_service.features) return result;
  result.candidate = meanOutscoring(candidate, held_out.reports);
  result.in_service = meanOutscoring(in_service, held_out.reports);
  result.judged = !std::isnan(result.candidate);
  result.passed = !result.judged || result.candidate >= result.in_service - options.tolerance;
  return result;
}

std::string inWords(const Comparison& comparison) {
  if (!comparison.judged)
    return fmt::format("{}: {} cases, too few to judge by", comparison.by, comparison.cases);
  return fmt::format("{}: candidate {:.3f}, in service {:.3f}, {} cases", comparison.by, comparison.candidate,
                     comparison.in_service, comparison.cases);
}

}  // namespace

void GateOptions::validate() const {
  requireOption(tolerance >= 0 && tolerance < 1, "tolerance", tolerance, "in [0, 1)");
  requireOption(min_reports >= 2, "min_reports", min_reports, "at least 2");
}

GateVerdict judgeCandidate(const Model& candidate, const Model& in_service, const HeldOut& held_out,
                           const GateOptions& options) {
  options.validate();
  GateVerdict verdict;
  verdict.comparisons = {byObjects(candidate, in_service, held_out, options.tolerance),
                         byReports(candidate, in_service, held_out, options)};
  verdict.passed = std::ranges::all_of(verdict.comparisons, &Comparison::passed);
  verdict.words = fmt::format("{} {} {}; {}; {}", candidate.version,
                              verdict.passed ? "is at least as good as" : "is worse than", in_service.version,
                              inWords(verdict.comparisons[0]), inWords(verdict.comparisons[1]));
  return verdict;
}

}  // namespace boxgrasp
