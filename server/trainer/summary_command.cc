#include "summary_command.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "boxgrasp/store/experience_store.h"
#include "boxgrasp/training/labelling.h"
#include "print_json.h"

namespace boxgrasp {
namespace {

struct Mean {
  double sum = 0.0;
  std::int64_t n = 0;
  void add(double x) {
    if (std::isnan(x)) return;
    sum += x;
    ++n;
  }
  double value() const { return n > 0 ? sum / static_cast<double>(n) : NAN; }
};

struct Row {
  ModelRecord model;
  LabelCounts counts;
  Mean epsilon, nu;  // of the grasps in force closure
  Mean success;
  Mean hold;       // share of a hypothesis's labels, with its perturbations, that are held
  Mean deviation;  // of that, from one perturbation to the other
};

// The hypotheses of an object, of one source, one model after the other.
struct ObjectLabels {
  std::vector<std::size_t> rows;  // parallel to `labelled`
  std::vector<LabelledHypothesis> labelled;
};

void addRobustness(const std::vector<GraspLabel>& labels, Row& row) {
  Mean held;
  for (const GraspLabel& label : labels) held.add(label.outcome == TrialOutcome::held);
  row.hold.add(held.value());
  if (held.n > 1) row.deviation.add(std::sqrt(held.value() * (1 - held.value())));
}

void addMeans(const ObjectLabels& object, std::vector<Row>& rows) {
  const VectorXd s = successes(object.labelled);
  for (std::size_t i = 0; i < object.rows.size(); ++i) {
    const GraspLabel* label = labelAsPlanned(object.labelled[i]);
    if (!label) continue;
    Row& row = rows[object.rows[i]];
    row.epsilon.add(label->force_closure ? label->epsilon : NAN);
    row.nu.add(label->force_closure ? label->nu : NAN);
    addRobustness(object.labelled[i].labels, row);
    row.success.add(s[static_cast<Eigen::Index>(i)]);
  }
}

std::vector<Row> rowsOf(const ExperienceStore& store) {
  std::vector<Row> rows;
  std::map<std::pair<std::string, GraspSource>, ObjectLabels> objects;
  for (const LabelCounts& counts : store.counts()) {
    ObjectLabels& object = objects[{counts.model.object, counts.source}];
    for (LabelledHypothesis& labelled : store.labelled(counts.model, counts.source)) {
      object.rows.push_back(rows.size());
      object.labelled.push_back(std::move(labelled));
    }
    rows.push_back({*store.model(counts.model), counts, {}, {}, {}, {}, {}});
  }
  for (const auto& [name, object] : objects) addMeans(object, rows);
  return rows;
}

struct Totals {
  std::int64_t models = 0, projections = 0, triplets = 0, configurations = 0, hypotheses = 0, labels = 0;
};

Totals totalsOf(const ExperienceStore& store, const std::vector<Row>& rows) {
  Totals totals;
  for (const ModelRecord& model : store.models()) {
    ++totals.models;
    totals.projections += model.projections;
    totals.triplets += model.triplets;
    totals.configurations += model.configurations;
  }
  for (const Row& row : rows) {
    totals.hypotheses += row.counts.hypotheses;
    totals.labels += row.counts.labels;
  }
  return totals;
}

nlohmann::json jsonOf(const Row& row) {
  nlohmann::json outcomes;
  for (std::size_t i = 0; i < row.counts.outcomes.size(); ++i)
    outcomes[std::string(describe(static_cast<TrialOutcome>(i)))] = row.counts.outcomes[i];
  return {{"model", formatModelKey(row.model.key)},
          {"source", describe(row.counts.source)},
          {"boxes", row.model.boxes},
          {"leaves", row.model.leaves},
          {"projections", row.model.projections},
          {"triplets", row.model.triplets},
          {"configurations", row.model.configurations},
          {"hypotheses", row.counts.hypotheses},
          {"labels", row.counts.labels},
          {"outcomes", outcomes},
          {"epsilon", row.epsilon.value()},
          {"nu", row.nu.value()},
          {"s", row.success.value()},
          {"hold", row.hold.value()},
          {"hold_deviation", row.deviation.value()}};
}

void printRows(const std::vector<Row>& rows, const Totals& totals) {
  nlohmann::json models = nlohmann::json::array();
  for (const Row& row : rows) models.push_back(jsonOf(row));
  printJson(nlohmann::json{{"schema", 1},
                           {"models", models},
                           {"totals",
                            {{"models", totals.models},
                             {"projections", totals.projections},
                             {"triplets", totals.triplets},
                             {"configurations", totals.configurations},
                             {"hypotheses", totals.hypotheses},
                             {"labels", totals.labels}}},
                           {"paper", {{"models", 42}, {"projections", 570}, {"triplets", 5951}}}});
}

void printTable(const std::vector<Row>& rows) {
  fmt::print(
      "{:<24} {:<8} {:>5} {:>5} {:>8} {:>7} {:>7} {:>7} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>7} {:>8} "
      "{:>6} {:>6} {:>6}\n",
      "model", "source", "boxes", "faces", "triplets", "confs", "hypoth.", "labels", "missed", "collid",
      "unstab", "lift", "shake", "held", "eps", "nu", "s", "hold", "+-");
  for (const Row& row : rows) {
    const auto& outcomes = row.counts.outcomes;
    fmt::print(
        "{:<24} {:<8} {:>5} {:>5} {:>8} {:>7} {:>7} {:>7} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>7.4f} "
        "{:>8.5f} {:>6.3f} {:>6.3f} {:>6.3f}\n",
        formatModelKey(row.model.key), describe(row.counts.source), row.model.boxes, row.model.projections,
        row.model.triplets, row.model.configurations, row.counts.hypotheses, row.counts.labels, outcomes[0],
        outcomes[1], outcomes[2], outcomes[3], outcomes[4], outcomes[5], row.epsilon.value(), row.nu.value(),
        row.success.value(), row.hold.value(), row.deviation.value());
  }
  fmt::print(
      "eps, nu: means of the force closures; s: Eq. 6; hold: share held over all perturbations, +-: its "
      "deviation between those of one grasp\n");
}

}  // namespace

void runSummary(const SummaryCommand& command) {
  const ExperienceStore store = ExperienceStore::openForReading(command.store);
  const std::vector<Row> rows = rowsOf(store);
  const Totals totals = totalsOf(store, rows);
  if (command.json) return printRows(rows, totals);
  printTable(rows);
  fmt::print(
      "{} models, {} projections, {} triplets, {} configurations (the paper: 42 models, 570 projections, "
      "5951 "
      "triplets); {} hypotheses, {} labels\n",
      totals.models, totals.projections, totals.triplets, totals.configurations, totals.hypotheses,
      totals.labels);
}

}  // namespace boxgrasp
