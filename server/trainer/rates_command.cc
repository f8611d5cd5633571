#include "rates_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/parallel.h"
#include "boxgrasp/simulation/protocols.h"
#include "boxgrasp/training/baselines.h"
#include "interruption.h"
#include "left_out.h"
#include "print_json.h"
#include "progress_bar.h"
#include "tried_object.h"

namespace boxgrasp {
namespace {

using nlohmann::json;

constexpr std::size_t kTop = 5;  // of the planner's answer
const std::string kNoGrasp = "no grasp";

enum class Protocol { lift, lift_shake, six_pushes, six_gravities };
const std::map<std::string, Protocol> kProtocols{{"lift", Protocol::lift},
                                                 {"lift_shake", Protocol::lift_shake},
                                                 {"six_pushes", Protocol::six_pushes},
                                                 {"six_gravities", Protocol::six_gravities}};

// How some plans or grasps ended: word -> how many. "held" is the good one.
struct Endings {
  std::map<std::string, std::size_t> words;

  void add(std::string_view word) { ++words[std::string(word)]; }
  void add(const Endings& other) {
    for (const auto& [word, count] : other.words) words[word] += count;
  }
  std::size_t held() const {
    const auto found = words.find("held");
    return found == words.end() ? 0 : found->second;
  }
  std::size_t of() const {
    return std::accumulate(words.begin(), words.end(), std::size_t{0},
                           [](std::size_t sum, const auto& word) { return sum + word.second; });
  }
};

// The columns of the table. Those of the answer count plans, or places in it: a plan without grasps failed.
struct Rates {
  std::string object;
  Endings hypotheses, best_tenth, worst_tenth, first, top, any, random, random_clear;
  std::size_t found = 0;  // hypotheses of all plans, tried or not
  double plan_time_s = 0.0;

  double perPlan(double sum) const { return sum / std::max(1.0, static_cast<double>(first.of())); }
};

struct Column {
  const char *name, *meaning;
  Endings Rates::*endings;
};
constexpr std::array<Column, 8> kColumns{
    {{"first", "plans whose best grasp by the planner's ranking was held; without a grasp it was not",
      &Rates::first},
     {"any of five", "plans of whose first five one was held", &Rates::any},
     {"first five", "grasps among the first five of a plan", &Rates::top},
     {"hypotheses", "the planner's grasps, unranked", &Rates::hypotheses},
     {"best tenth", "of them, by s (Eq. 6) of the simulated contacts", &Rates::best_tenth},
     {"worst tenth", "likewise", &Rates::worst_tenth},
     {"random", "poses turned towards the object; the hand closes where it meets it", &Rates::random},
     {"random clear", "the same, a touch on the way in being a failure as for the planner's",
      &Rates::random_clear}}};

// How a grasp ended, and what it was worth where that was asked.
struct Tried {
  std::string ending;
  TrialResult trial;
};

std::vector<HypothesisRecord> evenly(const std::vector<HypothesisRecord>& all, int limit) {
  const std::size_t n = all.size(), count = limit ? std::min(n, static_cast<std::size_t>(limit)) : n;
  std::vector<HypothesisRecord> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(all[i * n / count]);
  return chosen;
}

std::vector<std::string> viewsOf(const RatesCommand& command) {
  if (command.seen == "whole") return {wholeName()};
  if (command.seen == "view") return viewNames(command.views);
  if (command.seen == "pair") return pairNames(command.views);
  throw InputError(fmt::format("--seen is '{}', but must be whole, view or pair", command.seen));
}

Protocol protocolOf(const RatesCommand& command) {
  const auto found = kProtocols.find(command.protocol);
  if (found != kProtocols.end()) return found->second;
  throw InputError(fmt::format(
      "--protocol is '{}', but must be lift, lift_shake, six_pushes or six_gravities", command.protocol));
}

StudyCommand studyOf(const RatesCommand& command) {
  StudyCommand study;
  study.store = command.store;
  study.meshes = command.meshes;
  study.hand = command.hand;
  study.threads = command.threads;
  return study;
}

// All plans and trials of one kind of sight.
class Rater {
 public:
  Rater(const RatesCommand& command, const StopToken& stop)
      : command_(command),
        stop_(stop),
        protocol_(protocolOf(command)),
        views_(viewsOf(command)),
        planning_(planningWith(command.hand, command.config)) {
    planning_.options.threads = command.threads;
    if (!command.store) return;
    StudyCommand study = studyOf(command);
    study.recollections = planning_.options.recall.enabled;
    left_out_ = std::make_unique<LeftOut>(study, stop);
  }

  Rates ratesOf(const ObjectSource& source);
  const std::vector<double>& firstBySeed() const { return first_by_seed_; }
  const std::vector<std::string>& changedOptions() const { return planning_.changed; }
  void finish();

 private:
  Tried tryOne(const TriedObject& object, const HypothesisRecord& grasp, const TrialOptions& options) const;
  std::vector<Tried> tryAll(const TriedObject& object, const std::vector<HypothesisRecord>& grasps,
                            GraspSource like);
  void addPlan(const TriedObject& object, const std::string& view, int seed_index, Rates& rates);
  void addAnswer(const std::vector<Tried>& answer, std::size_t seed_index, Rates& rates);
  void addRandom(const TriedObject& object, Rates& rates);

  const RatesCommand& command_;
  const StopToken& stop_;
  Protocol protocol_;
  std::vector<std::string> views_;
  Planning planning_;
  std::unique_ptr<LeftOut> left_out_;
  std::map<std::size_t, Endings> first_;  // by seed
  std::vector<double> first_by_seed_;
};

Tried Rater::tryOne(const TriedObject& object, const HypothesisRecord& grasp,
                    const TrialOptions& options) const {
  const TrialInput input = trialInput(grasp);
  switch (protocol_) {
    case Protocol::six_pushes: {
      const SixPushResult result = pushSixWays(planning_.hand, object.solid, input, options, {}, stop_);
      return {std::string(describe(result.outcome)), {}};
    }
    case Protocol::six_gravities: {
      const SixGravityResult result =
          holdInSixGravities(planning_.hand, object.solid, input, options, {}, stop_);
      return {std::string(describe(result.outcome)), {}};
    }
    case Protocol::lift:
    case Protocol::lift_shake:
      break;
  }
  TrialResult result = runTrial(planning_.hand, object.solid, input, options, stop_);
  return {std::string(describe(result.outcome)), std::move(result)};
}

std::vector<Tried> Rater::tryAll(const TriedObject& object, const std::vector<HypothesisRecord>& grasps,
                                 GraspSource like) {
  const TrialOptions options =
      trialOptions(like, protocol_ == Protocol::lift ? TrialStage::lift : TrialStage::shake);
  std::vector<Tried> tried(grasps.size());
  parallelFor(grasps.size(), command_.threads,
              [&](std::size_t i) { tried[i] = tryOne(object, grasps[i], options); });
  return tried;
}

Endings endingsOf(const std::vector<Tried>& tried) {
  Endings endings;
  for (const Tried& one : tried) endings.add(one.ending);
  return endings;
}

void addTenths(const std::vector<Tried>& tried, Rates& rates) {
  std::vector<TrialResult> results;
  for (const Tried& one : tried) results.push_back(one.trial);
  const VectorXd s = successesOf(results);
  std::vector<Eigen::Index> order(results.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return s[a] > s[b]; });
  for (std::size_t i = 0; i < order.size() / 10; ++i) {
    rates.best_tenth.add(tried[static_cast<std::size_t>(order[i])].ending);
    rates.worst_tenth.add(tried[static_cast<std::size_t>(order[order.size() - 1 - i])].ending);
  }
}

void Rater::addAnswer(const std::vector<Tried>& answer, std::size_t seed_index, Rates& rates) {
  const std::string first = answer.empty() ? kNoGrasp : answer.front().ending;
  const bool any =
      std::any_of(answer.begin(), answer.end(), [](const Tried& tried) { return tried.ending == "held"; });
  rates.first.add(first);
  first_[seed_index].add(first);
  rates.any.add(any ? "held" : first);
  rates.top.add(endingsOf(answer));
}

void Rater::addPlan(const TriedObject& object, const std::string& view, int seed_index, Rates& rates) {
  const SightOptions sight{.cameras = command_.views,
                           .seed = command_.seed + static_cast<unsigned>(seed_index)};
  FoundGrasps found = findGrasps(planning_, object, view, sight, stop_);
  rates.found += found.hypotheses.size();
  rates.plan_time_s += found.time_s;
  found.answer.resize(std::min(found.answer.size(), kTop));
  addAnswer(tryAll(object, found.answer, GraspSource::planner), static_cast<std::size_t>(seed_index), rates);
  if (command_.answers_only) return;
  const std::vector<Tried> hypotheses =
      tryAll(object, evenly(found.hypotheses, command_.limit), GraspSource::planner);
  rates.hypotheses.add(endingsOf(hypotheses));
  if (protocol_ == Protocol::lift || protocol_ == Protocol::lift_shake) addTenths(hypotheses, rates);
}

void Rater::addRandom(const TriedObject& object, Rates& rates) {
  const std::vector<HypothesisRecord> random =
      randomHypotheses(planning_.hand, object.mesh_O, command_.random, command_.seed);
  rates.random = endingsOf(tryAll(object, random, GraspSource::random));
  rates.random_clear = endingsOf(tryAll(object, random, GraspSource::planner));
}

Rates Rater::ratesOf(const ObjectSource& source) {
  const TriedObject object = triedObject(source, stop_);
  if (left_out_) planning_.model = left_out_->modelWithout(object.name, stop_);
  Rates rates;
  rates.object =
      command_.scales.size() > 1 ? fmt::format("{}@{:.2f}", object.name, object.scale) : object.name;
  for (int seed_index = 0; seed_index < command_.seeds; ++seed_index) {
    for (const std::string& view : views_) addPlan(object, view, seed_index, rates);
  }
  if (!command_.answers_only) addRandom(object, rates);
  return rates;
}

void Rater::finish() {
  for (const auto& [seed, endings] : first_)
    first_by_seed_.push_back(static_cast<double>(endings.held()) / static_cast<double>(endings.of()));
}

Rates sumOf(const std::vector<Rates>& all) {
  Rates sum;
  sum.object = "all";
  for (const Rates& rates : all) {
    for (const Column& column : kColumns) (sum.*column.endings).add(rates.*column.endings);
    sum.found += rates.found;
    sum.plan_time_s += rates.plan_time_s;
  }
  return sum;
}

void printRow(const Rates& rates) {
  fmt::print("{:<16}", rates.object);
  for (const Column& column : kColumns) {
    const Endings& endings = rates.*column.endings;
    const std::string text =
        endings.of()
            ? fmt::format("{:.0f} % of {}",
                          100.0 * static_cast<double>(endings.held()) / static_cast<double>(endings.of()),
                          endings.of())
            : "-";
    fmt::print(" {:>14}", text);
  }
  fmt::print("\n");
}

void printTable(const std::vector<Rates>& all, const RatesCommand& command) {
  fmt::print("{:<16}", "held, " + command.protocol);
  for (const Column& column : kColumns) fmt::print(" {:>14}", column.name);
  fmt::print("\n");
  for (const Rates& rates : all) printRow(rates);
  const Rates sum = sumOf(all);
  printRow(sum);
  fmt::print("how the first grasps ended:");
  for (const auto& [word, count] : sum.first.words) fmt::print(" {} {};", count, word);
  fmt::print("\nof one plan: {:.0f} hypotheses, {:.3f} s\n", sum.perPlan(static_cast<double>(sum.found)),
             sum.perPlan(sum.plan_time_s));
  for (const Column& column : kColumns) fmt::print("{}: {}\n", column.name, column.meaning);
}

json asJson(const Rates& rates) {
  json row{{"object", rates.object}, {"found", rates.found}, {"plan_time_s", rates.plan_time_s}};
  for (const Column& column : kColumns) {
    std::string key = column.name;
    std::replace(key.begin(), key.end(), ' ', '_');
    const Endings& endings = rates.*column.endings;
    row[key] = {{"held", endings.held()}, {"of", endings.of()}, {"endings", endings.words}};
  }
  return row;
}

void checkOptions(const RatesCommand& command) {
  requireOption(command.random >= 0 && command.random <= 100'000, "--random", command.random,
                "in [0, 100000]");
  requireOption(command.limit >= 0, "--limit", command.limit, "at least 0");
  requireOption(command.views >= 1 && command.views <= 64, "--views", command.views, "in [1, 64]");
  requireOption(command.seeds >= 1 && command.seeds <= 100, "--seeds", command.seeds, "in [1, 100]");
  requireOption(command.threads >= 0, "--threads", command.threads, "at least 0");
}

json reportOf(const std::vector<Rates>& all, const Rater& rater, const RatesCommand& command) {
  json report{{"schema", 1},
              {"protocol", command.protocol},
              {"seen", command.seen},
              {"changed_options", rater.changedOptions()},
              {"objects", json::array()},
              {"all", asJson(sumOf(all))},
              {"first_by_seed", rater.firstBySeed()}};
  for (const Rates& rates : all) report["objects"].push_back(asJson(rates));
  return report;
}

}  // namespace

void runRates(const RatesCommand& command) {
  checkOptions(command);
  const StopToken stop = stopOnInterrupt();
  Rater rater(command, stop);
  std::vector<Rates> all;
  const std::vector<ObjectSource> sources = sourcesOf(command.objects, command.scales);
  ProgressBar bar("objects");
  for (std::size_t i = 0; i < sources.size(); ++i) {
    try {
      all.push_back(rater.ratesOf(sources[i]));
    } catch (const InputError& error) {
      fmt::print(stderr, "boxgrasp-trainer: left out: {}\n", error.what());
    }
    bar.update(i + 1, sources.size());
  }
  rater.finish();
  if (command.json)
    printJson(reportOf(all, rater, command));
  else
    printTable(all, command);
}

}  // namespace boxgrasp
