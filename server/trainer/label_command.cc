#include "label_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/base/parallel.h"
#include "boxgrasp/objects/object_set.h"
#include "boxgrasp/store/experience_store.h"
#include "boxgrasp/store/number_text.h"
#include "boxgrasp/training/labelling.h"
#include "boxgrasp/training/sights.h"
#include "interruption.h"
#include "print_json.h"
#include "progress_bar.h"
#include "tried_object.h"

namespace boxgrasp {
namespace {

// Labels of one transaction: what a kill loses at most, a few seconds of work.
constexpr std::size_t kBatch = 32;

TrialStage parseStage(const std::string& name) {
  const std::map<std::string, TrialStage> stages{{"close", TrialStage::close},
                                                 {"lift", TrialStage::lift},
                                                 {"shake", TrialStage::shake},
                                                 {"push", TrialStage::push}};
  const auto found = stages.find(name);
  if (found != stages.end()) return found->second;
  throw InputError(fmt::format("--last-stage is '{}', but must be close, lift, shake or push", name));
}

std::vector<GraspSource> parseSources(const std::vector<std::string>& names) {
  std::vector<GraspSource> sources;
  for (const std::string& name : names) {
    const std::optional<GraspSource> source = parseGraspSource(name);
    if (!source)
      throw InputError(fmt::format("--sources has '{}', but knows planner, random and approach", name));
    sources.push_back(*source);
  }
  return sources;
}

LabellingOptions optionsOf(const LabelCommand& command) {
  LabellingOptions options;
  options.limit = command.limit;
  options.random = command.random;
  options.last_stage = parseStage(command.last_stage);
  options.protocols = command.protocols;
  options.seed = command.seed;
  options.planner.threads = 1;  // models are planned in parallel
  options.validate();
  requireOption(command.views >= 0 && command.views <= 64, "views", command.views, "in [0, 64]");
  requireOption(command.perturbations >= 0, "perturbations", command.perturbations, "at least 0");
  requireOption(command.threads >= 0, "threads", command.threads, "at least 0");
  return options;
}

struct Shard {
  std::size_t index = 0, count = 1;
};

Shard parseShard(const std::string& text) {
  if (text.empty()) return {};
  std::string_view rest = text;
  const auto index = parseNumber<std::size_t>(takeFirst(rest, '/')), count = parseNumber<std::size_t>(rest);
  if (index && count && *index < *count) return {*index, *count};
  throw InputError(fmt::format("--shard is '{}', but must be i/n with i from 0 to n - 1, such as 0/4", text));
}

std::vector<ObjectSource> allObjects(const LabelCommand& command) {
  if (const auto parametric = parametricSet(command.objects, command.scales)) return *parametric;
  return meshFolder(command.objects, {command.scales, command.unit_m, command.target_size_m});
}

std::vector<ObjectSource> objectsOf(const LabelCommand& command) {
  std::vector<ObjectSource> all = allObjects(command);
  if (!command.only.empty()) {
    std::erase_if(all, [&](const ObjectSource& object) { return object.name != command.only; });
    if (all.empty())
      throw InputError(fmt::format("--only {}: no such object in '{}'", command.only, command.objects));
  }
  const Shard shard = parseShard(command.shard);
  std::vector<ObjectSource> chosen;
  for (std::size_t i = shard.index; i < all.size(); i += shard.count) chosen.push_back(all[i]);
  return chosen;
}

std::vector<std::string> viewsOf(const LabelCommand& command) {
  std::vector<std::string> views{wholeName()};
  std::ranges::copy(viewNames(command.views), std::back_inserter(views));
  if (command.pairs) std::ranges::copy(pairNames(command.views), std::back_inserter(views));
  return views;
}

// The run: first all models are planned, so that what is left to do is known, then they are labelled.
class Labeller {
 public:
  Labeller(const LabelCommand& command, const StopToken& stop)
      : command_(command),
        hand_(handOrBarrett(command.hand)),
        options_(optionsOf(command)),
        sources_(parseSources(command.sources)),
        views_(viewsOf(command)),
        objects_(objectsOf(command)),
        store_(ExperienceStore::openForWriting(command.out,
                                               labellingSettings(hand_, options_, BOXGRASP_VERSION))),
        stop_(stop) {}

  void planAll();
  void labelAll();
  std::size_t leftOut() const { return refusals_.size(); }
  void report() const;

 private:
  ModelKey keyOf(const ObjectSource& object, const std::string& view) const {
    return {object.name, object.scale, view};
  }
  bool planned(const ModelKey& key) const;
  void plan(std::size_t object);
  std::vector<PlannedModel> planViews(const ObjectSource& object,
                                      const std::vector<std::string>& views) const;
  std::size_t missing(const ObjectSource& object) const;
  void label(const ObjectSource& object);
  void label(const SimulatedObject& solid, const ModelKey& key, GraspSource source);
  void labelBatch(const SimulatedObject& solid, const ModelKey& key,
                  const std::vector<HypothesisRecord>& hypotheses, const std::vector<LabelSlot>& slots);

  LabelCommand command_;
  HandDescription hand_;
  LabellingOptions options_;
  std::vector<GraspSource> sources_;
  std::vector<std::string> views_;
  std::vector<ObjectSource> objects_;
  ExperienceStore store_;
  StopToken stop_;
  std::mutex storing_;
  std::map<std::size_t, std::string> refusals_;  // by object
  ProgressBar* bar_ = nullptr;
  std::size_t done_ = 0, total_ = 0;
  double time_s_ = 0.0;
};

bool Labeller::planned(const ModelKey& key) const {
  return store_.model(key) && std::ranges::all_of(sources_, [&](GraspSource source) {
           return !store_.hypotheses(key, source).empty();
         });
}

std::vector<PlannedModel> Labeller::planViews(const ObjectSource& object,
                                              const std::vector<std::string>& views) const {
  const TriangleMesh mesh_O = loadObject(object, stop_).mesh_O;
  std::vector<PlannedModel> models;
  for (const std::string& view : views) {
    models.push_back(
        planModel(hand_, mesh_O, keyOf(object, view), command_.views, sources_, options_, stop_));
  }
  return models;
}

void Labeller::plan(std::size_t index) {
  const ObjectSource& object = objects_[index];
  std::vector<std::string> views;
  {
    const std::lock_guard lock(storing_);
    std::ranges::copy_if(views_, std::back_inserter(views),
                         [&](const std::string& view) { return !planned(keyOf(object, view)); });
  }
  if (views.empty()) return;
  std::vector<PlannedModel> models;
  try {
    models = planViews(object, views);
  } catch (const InputError& error) {
    const std::lock_guard lock(storing_);
    refusals_[index] = error.what();
    return;
  }
  const std::lock_guard lock(storing_);
  for (const PlannedModel& model : models) store_.addModel(model.record, model.hypotheses);
}

void Labeller::planAll() {
  ProgressBar bar("planning");
  std::size_t done = 0;
  parallelFor(objects_.size(), command_.threads, [&](std::size_t i) {
    stop_.check();
    plan(i);
    const std::lock_guard lock(storing_);
    bar.update(++done, objects_.size());
  });
}

std::size_t Labeller::missing(const ObjectSource& object) const {
  std::size_t slots = 0;
  for (const std::string& view : views_) {
    for (const GraspSource source : sources_)
      slots += store_.missing(keyOf(object, view), source, command_.perturbations).size();
  }
  return slots;
}

void Labeller::labelBatch(const SimulatedObject& solid, const ModelKey& key,
                          const std::vector<HypothesisRecord>& hypotheses,
                          const std::vector<LabelSlot>& slots) {
  const auto hypothesisOf = [&](const LabelSlot& slot) -> const HypothesisRecord& {
    return *std::ranges::lower_bound(hypotheses, slot.index, {}, &HypothesisRecord::index);
  };
  std::vector<IndexedLabel> labels(slots.size());
  parallelFor(slots.size(), command_.threads, [&](std::size_t i) {
    const LabelSlot& slot = slots[i];
    labels[i] = {slot.index, labelGrasp(hand_, solid, key, hypothesisOf(slot), slot.perturbation, options_)};
  });
  store_.addLabels(key, hypotheses.front().source, labels);
  done_ += slots.size();
  bar_->update(done_, total_);
}

void Labeller::label(const SimulatedObject& solid, const ModelKey& key, GraspSource source) {
  const std::vector<LabelSlot> slots = store_.missing(key, source, command_.perturbations);
  const std::vector<HypothesisRecord> hypotheses = store_.hypotheses(key, source);
  for (std::size_t begin = 0; begin < slots.size(); begin += kBatch) {
    stop_.check();
    const std::size_t end = std::min(begin + kBatch, slots.size());
    labelBatch(solid, key, hypotheses, {slots.data() + begin, slots.data() + end});
  }
}

void Labeller::label(const ObjectSource& object) {
  const TriangleMesh mesh_O = loadObject(object, stop_).mesh_O;
  const SimulatedObject solid = makeSimulatedObject(mesh_O);
  for (const std::string& view : views_) {
    const ModelKey key = keyOf(object, view);
    if (store_.model(key)->mesh_hash != meshHash(mesh_O)) {
      throw InputError(fmt::format("the mesh of {} has changed since it was planned; label into a new store",
                                   formatModelKey(key)));
    }
    for (const GraspSource source : sources_) label(solid, key, source);
  }
}

void Labeller::labelAll() {
  std::vector<std::size_t> left(objects_.size(), 0);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (!refusals_.contains(i)) total_ += left[i] = missing(objects_[i]);
  }
  ProgressBar bar("labelling");
  bar_ = &bar;
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    stop_.check();
    if (left[i] > 0) label(objects_[i]);
  }
  time_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void Labeller::report() const {
  for (const auto& [index, why] : refusals_) {
    fmt::print(stderr, "left out: {} at scale {}: {}\n", objects_[index].name, objects_[index].scale, why);
  }
  if (command_.json) {
    printJson(nlohmann::ordered_json{{"schema", 1},
                                     {"store", command_.out.string()},
                                     {"labels_added", done_},
                                     {"time_s", time_s_},
                                     {"objects", objects_.size()},
                                     {"left_out", refusals_.size()}});
    return;
  }
  fmt::print("{} labels added", done_);
  if (done_ > 0) fmt::print(" in {:.0f} s, {:.1f} a second", time_s_, static_cast<double>(done_) / time_s_);
  fmt::print("; {} of {} objects left out; store: {}\n", refusals_.size(), objects_.size(),
             command_.out.string());
}

}  // namespace

int runLabel(const LabelCommand& command) {
  try {
    Labeller labeller(command, stopOnInterrupt());
    labeller.planAll();
    labeller.labelAll();
    labeller.report();
    return labeller.leftOut() > 0 ? kNothingFound : kDone;
  } catch (const Stopped&) {
    fmt::print(stderr,
               "stopped; {} keeps all that was finished: give the same command again to go on from there\n",
               command.out.string());
    return kInterrupted;
  }
}

}  // namespace boxgrasp
