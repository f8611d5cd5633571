#include "train_command.h"

#include <fmt/format.h>

#include <ctime>
#include <nlohmann/json.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/ranking/model_file.h"
#include "interruption.h"
#include "progress_bar.h"
#include "training_report.h"

namespace boxgrasp {
namespace {

std::string utcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string labelsInWords(const StudyData& data) {
  if (data.labels == "analytic")
    return "labelled with s (Eq. 6) computed from the planned contacts by the six-dimensional grasp wrench "
           "space; no simulated or real grasp was executed";
  const std::string_view target =
      data.target == LearningTarget::success ? "s (Eq. 6) of the contacts it found"
      : data.target == LearningTarget::hold
          ? "the share of perturbed trials held in lift and shake"
          : "s (Eq. 6) of the contacts it found, times the share of perturbed trials "
            "held in lift and shake";
  return fmt::format("tried in the dynamic simulator and labelled with {}; no real grasp was executed",
                     target);
}

void addMetrics(const std::string& prefix, const RankingVerdict& verdict, Model& model) {
  const auto add = [&](const std::string& name, double value) {
    if (std::isfinite(value)) model.metrics[prefix + name] = value;
  };
  add("s_net", verdict.s_net);
  add("s_net_fraction", verdict.fraction);
  add("list_fraction", verdict.list_fraction);
  add("top_held", verdict.top_held);
  add("top_held_perturbed", verdict.top_hold);
  add("any_of_five_held", verdict.any_of_five_held);
}

Model modelOf(const TrainCommand& command, const std::string& command_line, const StudyData& data,
              const StudyResult& result) {
  Model model;
  model.name = fmt::format("{}-{}", data.labels, describe(data.target));
  model.trained_on = fmt::format("{} planned grasps on {} objects in {} sizes and views, {}",
                                 data.samples.samples.targets.size(), result.network.objects.size(),
                                 data.lists.size(), labelsInWords(data));
  model.command = command_line;
  model.data_hash = dataHash(data.samples);
  model.seed = command.study.seed;
  model.created = utcNow();
  model.features = data.features;
  addMetrics("", result.network, model);
  addMetrics("best_measure_", result.measures.front(), model);
  addMetrics("best_of_nine_", bestOfNine(result.measures), model);
  addMetrics("random_", result.chance, model);
  model.metrics["samples"] = static_cast<double>(data.samples.samples.targets.size());
  if (result.reliability) {
    model.metrics["brier"] = result.reliability->brier;
    model.metrics["brier_of_the_mean"] = result.reliability->base_brier;
  }
  return model;
}

Learnt learnAll(const StudyCommand& command, const StudyData& data, const StopToken& stop) {
  ProgressBar bar("training");
  return learnNetworks(
      data.samples, learningOptions(command, data.target),
      [&](std::size_t done, std::size_t total) { bar.update(done, total); }, stop);
}

void print(const TrainCommand& command, const Model& model, const StudyResult& result) {
  if (command.json) {
    fmt::print("{}\n", nlohmann::json{{"schema", 1},
                                      {"version", model.version},
                                      {"file", command.out.string()},
                                      {"metrics", model.metrics}}
                           .dump(2));
    return;
  }
  fmt::print("{}model {} written to {}\n", verdictTable(result), model.version, command.out.string());
  if (command.report) fmt::print("report written to {}\n", command.report->string());
}

}  // namespace

void runTrain(const TrainCommand& command, const std::string& command_line) {
  if (command.labels != "analytic") {
    throw InputError(fmt::format(
        "--labels is '{}', but must be 'analytic' (s computed from planned contacts); simulated labels come "
        "with --store",
        command.labels));
  }
  const StopToken stop = stopOnInterrupt();
  const StudyData data = studyData(command.study, stop);
  const StudyResult result = evaluated(command.study, data, stop);
  const std::vector<SweepPoint> points =
      command.sweep ? sweep(command.study, data, stop) : std::vector<SweepPoint>();
  const Learnt learnt = learnAll(command.study, data, stop);
  Model model = modelOf(command, command_line, data, result);
  model.ensemble = learnt.ensemble;
  const VectorXd foretold = result.validation.scores.rowwise().mean();
  model.recollections = recollectionsWithout("", remembered(command.study, data, foretold));
  model = writeModel(model, command.out);
  if (command.report)
    writeReport({command.study, data, result, learnt, model, points}, *command.report, stop);
  print(command, model, result);
}

}  // namespace boxgrasp
