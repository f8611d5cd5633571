#include "models_command.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/messaging/publication.h"
#include "plan_json.h"

namespace boxgrasp {
namespace {

std::string rowText(const model_info_t& model) {
  return fmt::format("{} {:<8}  {:<8}  {:<20}  {:<12}  {}{}{}\n", model.serving ? '*' : ' ', model.version,
                     model.state, model.created, model.key.substr(0, 12), model.name,
                     model.pinned ? " (pinned)" : "", model.reason.empty() ? "" : ": " + model.reason);
}

std::string modelText(const model_info_t& model) {
  std::string text;
  const auto line = [&](const char* what, const std::string& value) {
    if (!value.empty()) text += fmt::format("{:<14} {}\n", what, value);
  };
  line("version", model.version);
  line("name", model.name);
  line("state", model.state + (model.serving ? ", in service" : "") + (model.pinned ? ", pinned" : ""));
  line("reason", model.reason);
  line("signed by", model.key);
  line("created", model.created);
  line("trained on", model.trained_on);
  line("made by", model.command);
  line("data hash", model.data_hash);
  line("seed", fmt::format("{}", model.seed));
  line("features", model.features);
  line("networks", model.shape);
  for (const metric_t& metric : model.metrics) line(metric.name.c_str(), fmt::format("{:.6g}", metric.value));
  return text;
}

const model_info_t& find(const models_reply_t& reply, const std::string& version) {
  std::string known;
  for (const model_info_t& model : reply.models) {
    if (model.version == version) return model;
    known += " " + model.version;
  }
  throw InputError(fmt::format("the server has no model '{}'; it has{}", version, known));
}

models_reply_t listed(const std::string& lcm_url) {
  return askModels({.lcm_url = lcm_url}, models_request_t::LIST, "", nullptr);
}

// Of all metrics that one of the two has.
std::map<std::string, std::pair<double, double>> metricsOfBoth(const model_info_t& a, const model_info_t& b) {
  std::map<std::string, std::pair<double, double>> both;
  for (const auto& [name, value] : metricsOf(a)) both[name] = {value, NAN};
  for (const auto& [name, value] : metricsOf(b))
    both.try_emplace(name, NAN, NAN).first->second.second = value;
  return both;
}

Json comparisonJson(const model_info_t& a, const model_info_t& b) {
  Json metrics = Json::object();
  for (const auto& [name, values] : metricsOfBoth(a, b))
    metrics[name] = {{"a", values.first}, {"b", values.second}, {"difference", values.second - values.first}};
  return {{"schema", 1}, {"a", modelJson(a)}, {"b", modelJson(b)}, {"metrics", metrics}};
}

std::string comparisonText(const model_info_t& a, const model_info_t& b) {
  std::string text = fmt::format("{:<32} {:>20} {:>20}\n", "", a.version, b.version);
  const auto line = [&](const char* what, const std::string& left, const std::string& right) {
    text += fmt::format("{:<32} {:>20} {:>20}\n", what, left, right);
  };
  line("name", a.name, b.name);
  line("state", a.state, b.state);
  line("created", a.created, b.created);
  line("networks", a.shape, b.shape);
  line("same training data", "", a.data_hash == b.data_hash ? "yes" : "no");
  for (const auto& [name, values] : metricsOfBoth(a, b))
    text += fmt::format("{:<32} {:>20.6g} {:>20.6g} {:>+12.4g}\n", name, values.first, values.second,
                        values.second - values.first);
  return text;
}

}  // namespace

int runModelsList(const std::string& lcm_url, bool json) {
  const models_reply_t reply = listed(lcm_url);
  if (json) {
    Json models = Json::array();
    for (const model_info_t& model : reply.models) models.push_back(modelJson(model));
    fmt::print("{}\n", jsonText({{"schema", 1}, {"models", models}}));
    return kDone;
  }
  fmt::print("  {:<8}  {:<8}  {:<20}  {:<12}  {}\n", "version", "state", "created", "signed by", "name");
  for (const model_info_t& model : reply.models) fmt::print("{}", rowText(model));
  return kDone;
}

int runModelsShow(const ModelsCommand& command, const std::string& lcm_url, bool json) {
  const models_reply_t reply = listed(lcm_url);
  const model_info_t& model = find(reply, command.version);
  if (json) {
    Json shown{{"schema", 1}};
    shown.update(modelJson(model));
    fmt::print("{}\n", jsonText(shown));
  } else {
    fmt::print("{}", modelText(model));
  }
  return kDone;
}

int runModelsCompare(const ModelsCommand& command, const std::string& lcm_url, bool json) {
  const models_reply_t reply = listed(lcm_url);
  const model_info_t &a = find(reply, command.version), &b = find(reply, command.other);
  fmt::print("{}", json ? jsonText(comparisonJson(a, b)) + "\n" : comparisonText(a, b));
  return kDone;
}

int runModelsOrder(const ModelsCommand& command, int action, const std::string& lcm_url, bool json) {
  const SigningKey key(command.key.value());
  const models_reply_t reply =
      askModels({.lcm_url = lcm_url}, static_cast<std::int8_t>(action), command.version, &key);
  const bool done = reply.done != 0;
  if (json) fmt::print("{}\n", jsonText({{"schema", 1}, {"done", done}, {"message", reply.message}}));
  if (!done)
    fmt::print(stderr, "boxgrasp: {}\n", reply.message);
  else if (!json)
    fmt::print("{}\n", reply.message);
  return done ? kDone : kBadInput;
}

}  // namespace boxgrasp
