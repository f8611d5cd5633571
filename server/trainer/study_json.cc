#include "study_json.h"

#include <nlohmann/json.hpp>

namespace boxgrasp {
namespace {

// JSON has no NaN.
nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

nlohmann::json jsonOf(const RankingVerdict& verdict) {
  return {{"ranking", verdict.ranking},
          {"s_net", number(verdict.s_net)},
          {"span_fraction", number(verdict.fraction)},
          {"span_fraction_deviation", number(verdict.deviation)},
          {"best_tenth", number(verdict.best_tenth)},
          {"worst_tenth", number(verdict.worst_tenth)},
          {"list_span_fraction", number(verdict.list_fraction)},
          {"hold_span_fraction", number(verdict.hold_fraction)},
          {"top_1_held", number(verdict.top_held)},
          {"top_1_held_perturbed", number(verdict.top_hold)},
          {"any_of_top_5_held", number(verdict.any_of_five_held)}};
}

nlohmann::json jsonOf(const ObjectVerdict& object) {
  return {{"object", object.object},
          {"grasps", object.grasps},
          {"s_net", number(object.success.value)},
          {"ceiling", number(object.success.ceiling)},
          {"floor", number(object.success.floor)},
          {"span_fraction", number(object.success.fraction)},
          {"best_tenth", number(object.success.mean_best_tenth)},
          {"worst_tenth", number(object.success.mean_worst_tenth)}};
}

nlohmann::json jsonOf(const Reliability& reliability) {
  nlohmann::json bins = nlohmann::json::array();
  for (const Reliability::Bin& bin : reliability.bins)
    bins.push_back({{"grasps", bin.grasps}, {"said", number(bin.said)}, {"happened", number(bin.happened)}});
  return {{"brier", reliability.brier}, {"brier_of_the_mean", reliability.base_brier}, {"bins", bins}};
}

}  // namespace

nlohmann::json studyJson(const StudyData& data, const StudyResult& result) {
  nlohmann::json objects = nlohmann::json::array(), measures = nlohmann::json::array();
  for (const ObjectVerdict& object : result.network.objects) objects.push_back(jsonOf(object));
  for (const RankingVerdict& measure : result.measures) measures.push_back(jsonOf(measure));
  nlohmann::json json{{"schema", 1},
                      {"labels", data.labels},
                      {"target", describe(data.target)},
                      {"features", data.features},
                      {"samples", data.samples.samples.targets.size()},
                      {"lists", data.lists.size()},
                      {"data_hash", dataHash(data.samples)},
                      {"network", jsonOf(result.network)},
                      {"random", jsonOf(result.chance)},
                      {"best_of_q1_to_q9", jsonOf(bestOfNine(result.measures))},
                      {"measures", measures},
                      {"objects", objects},
                      {"time_s", result.validation.time_s}};
  if (result.recalled) json["recalled"] = jsonOf(*result.recalled);
  if (result.reliability) json["reliability"] = jsonOf(*result.reliability);
  return json;
}

nlohmann::json sweepJson(const std::vector<SweepPoint>& points) {
  nlohmann::json json = nlohmann::json::array();
  for (const SweepPoint& point : points)
    json.push_back({{"hidden", point.hidden},
                    {"s_net", number(point.s_net)},
                    {"span_fraction", number(point.fraction)},
                    {"time_s", point.time_s}});
  return json;
}

}  // namespace boxgrasp
