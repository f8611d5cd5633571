#include "boxgrasp/training/outcome_learning.h"

#include <algorithm>
#include <map>

#include "boxgrasp/base/error.h"
#include "boxgrasp/ranking/model_file.h"

namespace boxgrasp {
namespace {

double quantile(VectorXd values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<Eigen::Index>(share * static_cast<double>(values.size() - 1))];
}

// What each robot's reports are multiplied by, so that none has more than its share of all.
std::map<std::string, double> robotFactors(const std::vector<ReportedGrasp>& reports, double max_share) {
  std::map<std::string, double> weight, factor;
  for (const ReportedGrasp& report : reports) weight[report.robot] += report.weight;
  // With too few robots for the bound, all have the same share.
  const double bound = std::max(max_share, 1.0 / static_cast<double>(weight.size()));
  for (const auto& [robot, own] : weight) factor[robot] = 1.0;
  // Cutting one robot raises the shares of the others: until none is above the bound.
  for (std::size_t round = 0; round < weight.size(); ++round) {
    double all = 0.0;
    for (const auto& [robot, own] : weight) all += factor[robot] * own;
    for (const auto& [robot, own] : weight) {
      const double others = all - factor[robot] * own;
      if (factor[robot] * own > bound * all && others > 0) factor[robot] = bound / (1 - bound) * others / own;
    }
  }
  return factor;
}

VectorXd weightsOf(const std::vector<ReportedGrasp>& reports, double simulated_weight,
                   const OutcomeWeighing& weighing) {
  const auto factors = robotFactors(reports, weighing.max_robot_share);
  VectorXd weights(static_cast<Eigen::Index>(reports.size()));
  for (std::size_t i = 0; i < reports.size(); ++i)
    weights[static_cast<Eigen::Index>(i)] =
        weighing.report_weight * reports[i].weight * factors.at(reports[i].robot);
  const double most = weighing.max_share / (1 - weighing.max_share) * simulated_weight;
  if (weights.sum() > most) weights *= most / weights.sum();
  return weights;
}

}  // namespace

void OutcomeWeighing::validate() const {
  requireOption(report_weight >= 0, "report_weight", report_weight, "at least 0");
  requireOption(max_robot_share > 0 && max_robot_share <= 1, "max_robot_share", max_robot_share, "in (0, 1]");
  requireOption(max_share >= 0 && max_share < 1, "max_share", max_share, "in [0, 1)");
}

GroupedSamples joined(const GroupedSamples& simulated, const std::vector<ReportedGrasp>& reports,
                      const OutcomeWeighing& weighing) {
  weighing.validate();
  if (reports.empty()) return simulated;
  const Eigen::Index n = simulated.samples.targets.size(), m = std::ssize(reports),
                     features = simulated.samples.inputs.cols();
  GroupedSamples all{{MatrixXd(n + m, features), VectorXd(n + m), VectorXd::Ones(n + m)}, simulated.objects};
  all.samples.inputs.topRows(n) = simulated.samples.inputs;
  all.samples.targets.head(n) = simulated.samples.targets;
  if (simulated.samples.weights.size() == n) all.samples.weights.head(n) = simulated.samples.weights;
  const double success = quantile(simulated.samples.targets, 0.75),
               failure = simulated.samples.targets.minCoeff();
  for (Eigen::Index i = 0; i < m; ++i) {
    const ReportedGrasp& report = reports[static_cast<std::size_t>(i)];
    if (report.inputs.size() != features)
      throw InputError(fmt::format("the report of '{}' on request '{}' has {} inputs, not {}", report.robot,
                                   report.request_id, report.inputs.size(), features));
    all.samples.inputs.row(n + i) = report.inputs.transpose();
    all.samples.targets[n + i] = report.succeeded ? success : failure;
    all.objects.push_back("robot " + report.robot);
  }
  all.samples.weights.tail(m) = weightsOf(reports, all.samples.weights.head(n).sum(), weighing);
  return all;
}

bool heldOut(const std::string& name, int one_in) {
  return std::stoull(blake2bHex(name).substr(0, 15), nullptr, 16) % static_cast<unsigned>(one_in) == 0;
}

}  // namespace boxgrasp
