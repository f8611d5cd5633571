#include "study.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <sstream>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/parallel.h"
#include "boxgrasp/objects/object_set.h"
#include "boxgrasp/planning/features.h"
#include "boxgrasp/store/experience_store.h"
#include "boxgrasp/training/analytic_labels.h"
#include "boxgrasp/training/labelling.h"
#include "progress_bar.h"
#include "tried_object.h"

namespace boxgrasp {
namespace {

constexpr int kChanceRepeats = 200;

std::vector<std::string> listOf(const std::string& inputs) {
  if (inputs == "paper") return paperFeatures();
  if (inputs == "relative") return relativeFeatures();
  if (inputs == "all") return allFeatures();
  std::vector<std::string> features;
  std::istringstream text(inputs);
  for (std::string feature; std::getline(text, feature, ',');) features.push_back(feature);
  checkFeatures(features);
  return features;
}

std::vector<std::string> featuresOf(const StudyCommand& command) {
  if (command.inputs.empty()) return command.store ? allFeatures() : relativeFeatures();
  std::vector<std::string> features = listOf(command.inputs);
  if (!command.store && asksForWrenches(features))
    throw InputError(fmt::format(
        "--inputs {} has epsilon or nu, but without --store the labels are computed from these: the network "
        "would learn its own input; choose 'paper' or 'relative'",
        command.inputs));
  return features;
}

LearningTarget targetOf(const std::string& name) {
  for (const auto target : {LearningTarget::success, LearningTarget::hold, LearningTarget::both}) {
    if (describe(target) == name) return target;
  }
  throw InputError(fmt::format("--target is '{}', but must be s, hold or both", name));
}

bool chosen(const StudyCommand& command, const std::string& object) {
  return command.objects.empty() || std::ranges::find(command.objects, object) != command.objects.end();
}

// --- simulated labels

// The number in the line "name = value" of a store's settings.
std::uint64_t setting(const std::string& settings, const std::string& name) {
  std::istringstream lines(settings);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(name + " = ")) return std::stoull(line.substr(name.size() + 3));
  }
  throw InputError(fmt::format("the store's settings have no '{}': label into a new store", name));
}

std::vector<ObjectSource> sourcesFor(const StudyCommand& command, const std::vector<ModelRecord>& models) {
  std::vector<double> scales;
  for (const ModelRecord& model : models) scales.push_back(model.key.scale);
  std::ranges::sort(scales);
  scales.erase(std::ranges::unique(scales).begin(), scales.end());
  if (const auto parametric = parametricSet(command.meshes, scales)) return *parametric;
  return meshFolder(command.meshes, {.scales = scales});
}

const ObjectSource& sourceOf(const std::vector<ObjectSource>& sources, const ModelKey& key) {
  const auto found = std::ranges::find_if(sources, [&](const ObjectSource& source) {
    return source.name == key.object && source.scale == key.scale;
  });
  if (found != sources.end()) return *found;
  throw InputError(fmt::format("the store has labels of '{}', which is not among --meshes", key.object));
}

std::vector<LabelledModel> labelledModels(const ExperienceStore& store,
                                          const std::vector<ModelRecord>& records) {
  std::vector<LabelledModel> models;
  for (const ModelRecord& record : records) {
    LabelledModel& model = models.emplace_back();
    model.key = record.key;
    model.labelled = store.labelled(record.key, GraspSource::planner);
  }
  return models;
}

// Plans again, because the store keeps what was tried, not all that could be measured of it.
void measure(const StudyCommand& command, const HandDescription& hand, const LabellingOptions& options,
             const std::vector<std::string>& features, const std::vector<ModelRecord>& records,
             std::vector<LabelledModel>& models, const StopToken& stop) {
  const std::vector<ObjectSource> sources = sourcesFor(command, records);
  ProgressBar bar("planning again");
  std::mutex reporting;
  std::size_t done = 0;
  parallelFor(models.size(), command.threads, [&](std::size_t i) {
    stop.check();
    LabelledModel& model = models[i];
    const TriangleMesh mesh_O = loadObject(sourceOf(sources, model.key), stop).mesh_O;
    std::vector<HypothesisRecord> known;
    for (const LabelledHypothesis& one : model.labelled) known.push_back(one.hypothesis);
    model.measured =
        hypothesisMeasures(hand, mesh_O, model.key, command.views, known, features, options, stop);
    const std::lock_guard lock(reporting);
    bar.update(++done, models.size());
  });
}

std::vector<GraspList> simulatedLists(const StudyCommand& command, const HandDescription& hand,
                                      const std::vector<std::string>& features, const StopToken& stop) {
  const ExperienceStore store = ExperienceStore::openForReading(*command.store);
  LabellingOptions options;
  options.points = setting(store.settings(), "points");
  options.seed = setting(store.settings(), "seed");
  options.planner.threads = 1;
  std::vector<ModelRecord> records = store.models();
  std::erase_if(records, [&](const ModelRecord& record) { return !chosen(command, record.key.object); });
  std::vector<LabelledModel> models = labelledModels(store, records);
  measure(command, hand, options, features, records, models, stop);
  return graspLists(std::move(models));
}

// --- analytic labels

GraspList listOf(LabelledObject object) {
  GraspList list{.key = {object.name, object.scale},
                 .measures = std::move(object.measures),
                 .rows = {},
                 .success = std::move(object.success),
                 .held = {},
                 .hold = {},
                 .constellation = {},
                 .places = {}};
  for (Eigen::Index i = 0; i < list.success.size(); ++i) list.rows.push_back(i);
  list.held = list.hold = VectorXd::Constant(list.success.size(), NAN);
  return list;
}

std::vector<GraspList> analyticLists(const StudyCommand& command, const HandDescription& hand,
                                     const std::vector<std::string>& features, const StopToken& stop) {
  AnalyticLabelOptions options;
  options.objects = command.objects;
  options.points = command.points;
  options.features = features;
  options.seed = command.seed;
  options.threads = command.threads;
  ProgressBar bar("labelling");
  std::vector<GraspList> lists;
  const auto progress = [&](std::size_t done, std::size_t total) { bar.update(done, total); };
  for (LabelledObject& object : analyticLabels(hand, {}, options, progress, stop))
    lists.push_back(listOf(std::move(object)));
  return lists;
}

// --- evaluation

VectorXd outcomesOf(const std::vector<GraspList>& lists) {
  return samplesOf(lists, {}, LearningTarget::hold).samples.targets;
}

// Networks that have not seen an object, and recollections of the others. (The surprises on these come from
// networks that may have seen it, which says next to nothing of it.)
MatrixXd recalledScores(const StudyData& data, const MatrixXd& scores) {
  const std::vector<RememberedList> all =
      remembered(data.lists, data.samples.samples.targets, scores.rowwise().mean());
  MatrixXd result = scores;
  Eigen::Index begin = 0;
  for (const GraspList& list : data.lists) {
    const Eigen::Index n = std::ssize(list.rows);
    result.middleRows(begin, n).colwise() +=
        corrections(list.constellation, list.places, recollectionsWithout(list.key.object, all), {});
    begin += n;
  }
  return result;
}

std::string row(const RankingVerdict& verdict) {
  const auto percent = [](double share) {
    return std::isnan(share) ? std::string("-") : fmt::format("{:.1f}", 100 * share);
  };
  return fmt::format("{:<24} {:>7.3f} {:>7} {:>7} {:>7.3f} {:>7.3f} {:>7} {:>7} {:>7} {:>7}\n",
                     verdict.ranking, verdict.s_net, percent(verdict.fraction),
                     percent(verdict.list_fraction), verdict.best_tenth, verdict.worst_tenth,
                     percent(verdict.hold_fraction), percent(verdict.top_held), percent(verdict.top_hold),
                     percent(verdict.any_of_five_held));
}

}  // namespace

StudyData studyData(const StudyCommand& command, const StopToken& stop) {
  const HandDescription hand = handOrBarrett(command.hand);
  StudyData data;
  data.features = featuresOf(command);
  data.target = targetOf(command.target);
  if (!command.store && data.target != LearningTarget::success)
    throw InputError(fmt::format("--target {} needs --store: computed labels know s alone", command.target));
  if (command.recollections && !command.store)
    throw InputError("--recollections needs --store: without it nothing was tried that could be remembered");
  // The measures alone are what learning is compared with, so all of them are needed.
  const std::vector<std::string> measured = allFeatures();
  data.lists = command.store ? simulatedLists(command, hand, measured, stop)
                             : analyticLists(command, hand, measured, stop);
  // What cannot be ranked cannot be judged.
  std::erase_if(data.lists, [](const GraspList& list) { return list.rows.size() < 2; });
  data.labels = command.store ? "simulated" : "analytic";
  data.samples = samplesOf(data.lists, data.features, data.target);
  return data;
}

LearningOptions learningOptions(const StudyCommand& command, LearningTarget target) {
  LearningOptions options;
  if (command.hidden != std::vector{0})
    options.training.hidden = command.hidden;
  else
    options.training.hidden.clear();
  options.training.starts = command.starts;
  options.networks = command.networks;
  options.calibrate = target == LearningTarget::hold;
  options.seed = command.seed;
  options.threads = command.threads;
  return options;
}

CrossValidationOptions validationOptions(const StudyCommand& command, LearningTarget target, int repeats) {
  const LearningOptions learning = learningOptions(command, target);
  CrossValidationOptions options;
  options.training = learning.training;
  options.networks = learning.networks;
  options.calibrate = learning.calibrate;
  options.repeats = repeats;
  options.seed = command.seed;
  options.threads = command.threads;
  return options;
}

StudyResult evaluated(const StudyCommand& command, const StudyData& data, const StopToken& stop) {
  const CrossValidationOptions options = validationOptions(command, data.target, command.repeats);
  StudyResult result;
  {
    ProgressBar bar("leaving one object out");
    result.validation = leaveOneObjectOut(
        data.samples, options, stop, [&](std::size_t done, std::size_t total) { bar.update(done, total); });
  }
  result.network = judge("network", data.lists, result.validation.scores);
  if (command.store)
    result.recalled = judge("with recollections", data.lists, recalledScores(data, result.validation.scores));
  result.chance = judgeChance(data.lists, kChanceRepeats, command.seed);
  result.measures = judgeMeasures(data.lists);
  if (options.calibrate)
    result.reliability = reliabilityOf(result.validation.scores.rowwise().mean(), outcomesOf(data.lists));
  return result;
}

std::vector<RememberedList> remembered(const StudyCommand& command, const StudyData& data,
                                       const VectorXd& foretold) {
  if (!command.recollections) return {};
  return remembered(data.lists, data.samples.samples.targets, foretold);
}

const RankingVerdict& bestOfNine(const std::vector<RankingVerdict>& measures) {
  return *std::ranges::find_if(measures, [](const RankingVerdict& verdict) {
    return verdict.ranking[0] == 'q' && std::isdigit(static_cast<unsigned char>(verdict.ranking[1]));
  });
}

std::string verdictTable(const StudyResult& result) {
  std::string table =
      fmt::format("{:<24} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7}\n", "ranking by", "S_net",
                  "span %", "list %", "best", "worst", "hold %", "top-1 %", "shaken %", "top-5 %");
  table += row(result.network);
  if (result.recalled) table += row(*result.recalled);
  table += row(result.measures.front()) + row(bestOfNine(result.measures)) + row(result.chance);
  return table +
         "span: share of the span from the worst ranking to the perfect one by s, an object in all sizes; "
         "list: the same in one size;\nhold: by the share of perturbed trials held; top-1: first grasps held "
         "as planned; shaken: under perturbations; top-5: any of five held\n";
}

}  // namespace boxgrasp
