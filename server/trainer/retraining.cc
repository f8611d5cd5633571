#include "retraining.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "boxgrasp/base/durable_file.h"
#include "boxgrasp/base/error.h"
#include "boxgrasp/messaging/publication.h"
#include "boxgrasp/planning/default_model.h"

namespace boxgrasp {
namespace {

namespace fs = std::filesystem;

ReportedGrasp reportedGrasp(const StoredOutcome& stored) {
  const RobotOutcome& outcome = stored.outcome;
  const std::vector<double>& inputs = stored.grasp.inputs;
  return {outcome.robot, outcome.request_id, Eigen::Map<const VectorXd>(inputs.data(), std::ssize(inputs)),
          outcome.succeeded, outcome.weight};
}

struct SplitReports {
  std::vector<ReportedGrasp> training, held_out;
  std::size_t foreign = 0;  // made with other features, which say nothing to these networks
};

SplitReports splitReports(const std::vector<StoredOutcome>& outcomes,
                          const std::vector<std::string>& features, int one_in) {
  const std::string names = fmt::format("{}", fmt::join(features, " "));
  SplitReports split;
  for (const StoredOutcome& stored : outcomes) {
    if (stored.origin.features != names) {
      ++split.foreign;
      continue;
    }
    auto& part = heldOut(stored.outcome.request_id, one_in) ? split.held_out : split.training;
    part.push_back(reportedGrasp(stored));
  }
  return split;
}

// The weights of the model that the server uses: published from here, in the server's folder, or built in.
Model modelInService(const WorkCommand& command, const std::string& version) {
  const Model built_in = modelOrDefault({});
  if (version.empty() || version == built_in.version) return built_in;
  std::vector<fs::path> places{command.keep / (version + ".json")};
  if (command.state_dir) places.push_back(*command.state_dir / "models" / (version + ".json"));
  for (const fs::path& place : places) {
    if (fs::exists(place)) return readModel(place);
  }
  throw InputError(
      fmt::format("the server uses model {}, whose weights are not at hand to compare with; give the "
                  "server's --state-dir",
                  version));
}

Model candidateModel(const WorkCommand& command, const SplitLabels& labels, const GroupedSamples& data,
                     std::size_t reports, const Ensemble& ensemble) {
  Model model;
  model.name = fmt::format("retrained-{}", describe(labels.training.target));
  model.trained_on = fmt::format("{} simulated labels and {} outcomes that robots reported",
                                 labels.training.samples.samples.targets.size(), reports);
  model.command = "boxgrasp-trainer work";
  model.data_hash = dataHash(data);
  model.seed = command.study.seed;
  model.created = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  model.features = labels.training.features;
  model.ensemble = ensemble;
  return model;
}

nlohmann::ordered_json comparisonJson(const GateVerdict& verdict) {
  nlohmann::ordered_json json{{"schema", 1}, {"passed", verdict.passed}, {"words", verdict.words}};
  for (const Comparison& one : verdict.comparisons)
    json["comparisons"].push_back({{"by", one.by},
                                   {"candidate", one.candidate},
                                   {"in_service", one.in_service},
                                   {"cases", one.cases},
                                   {"judged", one.judged},
                                   {"passed", one.passed}});
  return json;
}

// What the server says to the candidate, in words.
std::string publish(const WorkCommand& command, const fs::path& file, RoundResult& result) {
  if (!command.key) return "not published: no --key was given";
  const model_reply_t reply = publishModel({command.lcm_url, 30.0}, file, SigningKey(*command.key));
  result.published = reply.outcome == model_reply_t::IN_SERVICE || reply.outcome == model_reply_t::KEPT;
  return fmt::format("{}: {}", result.published ? "published" : "refused by the server", reply.message);
}

}  // namespace

SplitLabels splitLabels(const WorkCommand& command, const StopToken& stop) {
  SplitLabels split;
  split.training = studyData(command.study, stop);
  auto& lists = split.training.lists;
  const auto kept = std::stable_partition(lists.begin(), lists.end(), [&](const GraspList& list) {
    return !heldOut(list.key.object, command.held_out_one_in);
  });
  split.held_out.assign(std::make_move_iterator(kept), std::make_move_iterator(lists.end()));
  lists.erase(kept, lists.end());
  if (split.held_out.empty())
    throw InputError(fmt::format(
        "none of the store's objects is among one in {} that are kept out to judge by; label more "
        "objects, or lower --held-out-one-in",
        command.held_out_one_in));
  split.training.samples = samplesOf(lists, split.training.features, split.training.target);
  return split;
}

RoundResult runRound(const WorkCommand& command, const SplitLabels& labels,
                     const std::vector<StoredOutcome>& outcomes, const std::string& in_service,
                     const std::function<void(const RoundProgress&)>& report, const StopToken& stop) {
  const Model before = modelInService(command, in_service);
  const SplitReports reports = splitReports(outcomes, labels.training.features, command.held_out_one_in);
  const GroupedSamples data = joined(labels.training.samples, reports.training);
  const Ensemble ensemble = learn(
      data, learningOptions(command.study, labels.training.target),
      [&](std::size_t done, std::size_t total) {
        report({training_status_t::TRAINING, fmt::format("network {} of {}", done, total),
                0.9 * static_cast<double>(done) / static_cast<double>(total)});
      },
      stop);
  report({training_status_t::COMPARING, "comparing with the model in service", 0.9});
  fs::create_directories(command.keep);
  const Model model = candidateModel(command, labels, data, reports.training.size(), ensemble);
  const fs::path unnamed = command.keep / "candidate.json";
  const Model candidate = writeModel(model, unnamed);
  const fs::path file = command.keep / (candidate.version + ".json");
  fs::rename(unnamed, file);
  const GateVerdict verdict =
      judgeCandidate(candidate, before, {labels.held_out, labels.training.target, reports.held_out});
  writeDurably(command.keep / (candidate.version + ".comparison.json"),
               comparisonJson(verdict).dump(2) + "\n");
  RoundResult result{candidate.version,
                     before.version,
                     labels.training.samples.samples.targets.size(),
                     std::ssize(outcomes) - static_cast<std::int64_t>(reports.foreign),
                     false,
                     verdict.words};
  if (reports.foreign > 0)
    result.words += fmt::format("; {} outcomes of grasps ranked by models with other inputs were left out",
                                reports.foreign);
  if (!verdict.passed) {
    result.words += "; kept, not published";
    return result;
  }
  report({training_status_t::PUBLISHING, "publishing", 0.95});
  result.words += "; " + publish(command, file, result);
  return result;
}

}  // namespace boxgrasp
