#include "rates_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "boxgrasp/base/error.h"
#include "boxgrasp/training/baselines.h"
#include "interruption.h"
#include "progress_bar.h"
#include "tried_object.h"

namespace boxgrasp {
namespace {

using nlohmann::json;

constexpr std::size_t kTop = 5;  // of the planner's answer

// How many of some grasps were held.
struct Share {
  std::size_t held = 0, of = 0;
  void add(const TrialResult& result) {
    held += result.outcome == TrialOutcome::held;
    ++of;
  }
  void add(const Share& other) {
    held += other.held;
    of += other.of;
  }
};

// The columns of the table.
struct Rates {
  explicit Rates(std::string name) : object(std::move(name)) {}
  std::string object;
  Share hypotheses, best_tenth, worst_tenth, first, top, random, random_clear;
};

struct Column {
  const char *name, *meaning;
  Share Rates::*share;
};
constexpr std::array<Column, 7> kColumns{
    {{"hypotheses", "the planner's, unranked", &Rates::hypotheses},
     {"best tenth", "of them, by s (Eq. 6) of the simulated contacts", &Rates::best_tenth},
     {"worst tenth", "likewise", &Rates::worst_tenth},
     {"first", "the best by the planner's ranking", &Rates::first},
     {"first five", "by the planner's ranking", &Rates::top},
     {"random", "poses turned towards the object; the hand closes where it meets it", &Rates::random},
     {"random clear", "the same, a touch on the way in being a failure as for the planner's",
      &Rates::random_clear}}};

std::vector<HypothesisRecord> evenly(const std::vector<HypothesisRecord>& all, int limit) {
  const std::size_t n = all.size(), count = limit ? std::min(n, static_cast<std::size_t>(limit)) : n;
  std::vector<HypothesisRecord> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(all[i * n / count]);
  return chosen;
}

Share shareOf(const std::vector<TrialResult>& results) {
  Share share;
  for (const TrialResult& result : results) share.add(result);
  return share;
}

void addTenths(const std::vector<TrialResult>& results, Rates& rates) {
  const VectorXd s = successesOf(results);
  std::vector<Eigen::Index> order(results.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return s[a] > s[b]; });
  for (std::size_t i = 0; i < order.size() / 10; ++i) {
    rates.best_tenth.add(results[order[i]]);
    rates.worst_tenth.add(results[order[order.size() - 1 - i]]);
  }
}

// One object's grasps of all kinds, tried.
Rates ratesOf(const ObjectSource& source, const RatesCommand& command, const StopToken& stop) {
  const HandDescription& hand = barrettHand();
  const TriedObject object = triedObject(source, stop);
  FoundGrasps found = findGrasps(hand, object.mesh_O, command.threads, stop);
  found.answer.resize(std::min(found.answer.size(), kTop));
  ProgressBar bar(object.name);
  const auto tried = [&](const std::vector<HypothesisRecord>& grasps, const TrialOptions& options) {
    return tryAll(hand, object.solid, grasps, options, command.threads, stop,
                  [&](std::size_t done) { bar.update(done, grasps.size()); });
  };
  const TrialOptions clear = trialOptions(GraspSource::planner, TrialStage::shake);
  const std::vector<TrialResult> hypotheses = tried(evenly(found.hypotheses, command.limit), clear);
  const std::vector<TrialResult> answer = tried(found.answer, clear);
  const auto random = randomHypotheses(hand, object.mesh_O, command.random, command.seed);
  Rates rates(object.name);
  rates.hypotheses = shareOf(hypotheses);
  rates.top = shareOf(answer);
  if (!answer.empty()) rates.first.add(answer.front());
  rates.random = shareOf(tried(random, trialOptions(GraspSource::random, TrialStage::shake)));
  rates.random_clear = shareOf(tried(random, clear));
  addTenths(hypotheses, rates);
  return rates;
}

Rates sumOf(const std::vector<Rates>& all) {
  Rates sum("all");
  for (const Rates& rates : all) {
    for (const Column& column : kColumns) (sum.*column.share).add(rates.*column.share);
  }
  return sum;
}

void printRow(const Rates& rates) {
  fmt::print("{:<16}", rates.object);
  for (const Column& column : kColumns) {
    const Share share = rates.*column.share;
    const std::string text =
        share.of ? fmt::format("{:.0f} % of {}", 100.0 * share.held / share.of, share.of) : "-";
    fmt::print(" {:>14}", text);
  }
  fmt::print("\n");
}

void printTable(const std::vector<Rates>& all) {
  fmt::print("{:<16}", "held in lift, shake");
  for (const Column& column : kColumns) fmt::print(" {:>14}", column.name);
  fmt::print("\n");
  for (const Rates& rates : all) printRow(rates);
  printRow(sumOf(all));
  for (const Column& column : kColumns) fmt::print("{}: {}\n", column.name, column.meaning);
}

json asJson(const Rates& rates) {
  json row{{"object", rates.object}};
  for (const Column& column : kColumns) {
    std::string key = column.name;
    std::replace(key.begin(), key.end(), ' ', '_');
    row[key] = {{"held", (rates.*column.share).held}, {"of", (rates.*column.share).of}};
  }
  return row;
}

}  // namespace

void runRates(const RatesCommand& command) {
  requireOption(command.random >= 0 && command.random <= 100'000, "--random", command.random,
                "in [0, 100000]");
  requireOption(command.limit >= 0, "--limit", command.limit, "at least 0");
  requireOption(command.threads >= 0, "--threads", command.threads, "at least 0");
  const StopToken stop = stopOnInterrupt();
  std::vector<Rates> all;
  for (const ObjectSource& source : sourcesOf(command.objects, command.scale)) {
    try {
      all.push_back(ratesOf(source, command, stop));
    } catch (const InputError& error) {
      fmt::print(stderr, "boxgrasp-trainer: left out: {}\n", error.what());
    }
  }
  if (!command.json) return printTable(all);
  json report{{"objects", json::array()}, {"all", asJson(sumOf(all))}};
  for (const Rates& rates : all) report["objects"].push_back(asJson(rates));
  fmt::print("{}\n", report.dump(2));
}

}  // namespace boxgrasp
