#include "training_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/random.h"
#include "html_text.h"
#include "study_plots.h"

namespace boxgrasp {
namespace {

using Eigen::Index;

constexpr std::string_view kStyle =
    "body{font:15px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222;background:#fff}"
    "table{border-collapse:collapse}td,th{padding:.2em .8em;text-align:left;border-bottom:1px solid #ccc}"
    "td{overflow-wrap:anywhere}pre{overflow-x:auto;background:#f4f4f4;padding:1em}svg{max-width:100%}";

constexpr std::size_t kMostImportances = 20;  // in the plot: more names cannot be read

// --- importance

VectorXd exchanged(const VectorXd& values, std::mt19937_64& random) {
  VectorXd result = values;
  for (Index i = result.size() - 1; i > 0; --i)
    std::swap(result[i], result[static_cast<Index>(uniformIndex(random, static_cast<std::uint64_t>(i) + 1))]);
  return result;
}

// Of the shipped networks on the data they know: what they use, not what they would be without.
std::vector<Importance> importances(const ReportedStudy& study, const StopToken& stop) {
  const auto fraction = [&](const MatrixXd& inputs) {
    return judge("", study.data.lists, scores(study.learnt.ensemble, inputs)).fraction;
  };
  const MatrixXd& inputs = study.data.samples.samples.inputs;
  const double whole = fraction(inputs);
  std::mt19937_64 random(study.command.seed);
  std::vector<Importance> result;
  for (Index i = 0; i < inputs.cols(); ++i) {
    stop.check();
    MatrixXd mixed = inputs;
    mixed.col(i) = exchanged(inputs.col(i), random);
    result.push_back({study.data.features[static_cast<std::size_t>(i)], whole - fraction(mixed)});
  }
  std::ranges::stable_sort(result, std::ranges::greater{}, &Importance::loss);
  if (result.size() > kMostImportances) result.resize(kMostImportances);
  return result;
}

// --- page

std::string tableRow(const std::string& name, const std::string& value) {
  return fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", escaped(name), escaped(value));
}

std::string dataCard(const StudyData& data) {
  std::vector<std::string> objects;
  for (const GraspList& list : data.lists) {
    if (objects.empty() || objects.back() != list.key.object) objects.push_back(list.key.object);
  }
  const double held = samplesOf(data.lists, {}, LearningTarget::hold).samples.targets.mean();
  std::string card = "<h2>Data card</h2><table>\n";
  card += tableRow("labels",
                   data.labels + (data.labels == "simulated"
                                      ? ": each grasp tried in the dynamic simulator: close, lift, shake"
                                      : ": computed from planned contacts"));
  card += tableRow("target", std::string(describe(data.target)));
  card += tableRow("grasps", fmt::format("{}", data.samples.samples.targets.size()));
  card += tableRow("objects", fmt::format("{} in {} sizes and views: {}", objects.size(), data.lists.size(),
                                          fmt::join(objects, ", ")));
  if (std::isfinite(held)) card += tableRow("held in lift and shake", fmt::format("{:.1f} %", 100 * held));
  card += tableRow("hash", dataHash(data.samples));
  return card + tableRow("limits", "closed, rigid objects of one density; no sensor noise; no real grasps") +
         "</table>\n";
}

std::string modelCard(const ReportedStudy& study) {
  const Model& model = study.model;
  std::string card = "<h2>Model card</h2><table>\n";
  card += tableRow("version", model.version);
  card += tableRow("command", model.command);
  card += tableRow("made", model.created);
  card += tableRow("networks", fmt::format("{} of {} inputs, hidden nodes {}{}", study.command.networks,
                                           model.features.size(), fmt::join(study.command.hidden, " x "),
                                           model.ensemble.calibration ? ", calibrated" : ""));
  card += tableRow("inputs", fmt::format("{}", fmt::join(model.features, ", ")));
  card += tableRow("trained on", model.trained_on);
  for (const auto& [name, value] : model.metrics) card += tableRow(name, fmt::format("{:.4g}", value));
  return card + tableRow("use", "to rank grasps of one object; not to tell whether a grasp is safe") +
         "</table>\n";
}

// By how much learning beats what needs none, in points of the span.
std::string gain(const StudyResult& result) {
  const RankingVerdict &network = result.network, &single = result.measures.front(),
                       &nine = bestOfNine(result.measures);
  const auto points = [](double better, double than) { return 100 * (better - than); };
  return fmt::format(
      "<p>Of the span between the worst ranking and the perfect one, the network reaches {:.1f} % (&plusmn; "
      "{:.1f} "
      "over {} repeats): {:+.1f} points beside the best of the paper's nine measures ({}), {:+.1f} beside "
      "the best "
      "of all measures ({}), {:+.1f} beside chance. In single sizes, as a plan ranks them: {:+.1f}, {:+.1f} "
      "and "
      "{:+.1f}.</p>\n",
      100 * network.fraction, 100 * network.deviation, result.validation.scores.cols(),
      points(network.fraction, nine.fraction), nine.ranking, points(network.fraction, single.fraction),
      single.ranking, points(network.fraction, result.chance.fraction),
      points(network.list_fraction, nine.list_fraction), points(network.list_fraction, single.list_fraction),
      points(network.list_fraction, result.chance.list_fraction));
}

std::string pageOf(const ReportedStudy& study, const StopToken& stop) {
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Training report {}</title>"
      "<style>{}</style></head><body>\n<h1>Training report: model {}</h1>\n",
      study.model.version, kStyle, study.model.version);
  page += fmt::format("<h2>Ranking grasps of objects never seen</h2><pre>{}</pre>\n",
                      escaped(verdictTable(study.result)));
  page += gain(study.result);
  std::vector<Plot> plots{comparisonPlot(study.result), spanPlot(study.result.network)};
  if (!study.sweep.empty()) plots.push_back(sweepPlot(study.sweep));
  if (study.result.reliability) plots.push_back(reliabilityPlot(*study.result.reliability));
  plots.push_back(importancePlot(importances(study, stop)));
  plots.push_back(learningCurves(study.learnt.trainings));
  for (const Plot& plot : plots) page += svgOf(plot, {.width_px = 960, .height_px = 480}) + "\n";
  return page + dataCard(study.data) + modelCard(study) + "</body></html>\n";
}

}  // namespace

void writeReport(const ReportedStudy& study, const std::filesystem::path& file, const StopToken& stop) {
  const std::string page = pageOf(study, stop);
  std::ofstream out(file);
  out << page << std::flush;
  if (!out)
    throw InputError(
        fmt::format("cannot write {}: is the folder there, and may it be written to?", file.string()));
}

}  // namespace boxgrasp
