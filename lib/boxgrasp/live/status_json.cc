#include "boxgrasp/live/status_json.h"

#include <map>
#include <string>

#include "boxgrasp/messaging/plan_conversion.h"

namespace boxgrasp {
namespace {

using Json = nlohmann::ordered_json;

std::string stateName(std::int8_t state) {
  switch (state) {
    case training_status_t::IDLE:
      return "idle";
    case training_status_t::TRAINING:
      return "training";
    case training_status_t::COMPARING:
      return "comparing";
    case training_status_t::PUBLISHING:
      return "publishing";
    default:
      return "unknown";
  }
}

}  // namespace

nlohmann::ordered_json statusJson(const status_t& status) {
  Json outcomes = Json::object();
  for (std::int8_t outcome = 0; outcome < static_cast<int>(std::size(status.outcomes)); ++outcome)
    outcomes[std::string(outcomeName(outcome))] = status.outcomes[outcome];
  return {{"schema", 1},
          {"version", status.version},
          {"model_version", status.model_version},
          {"hand", status.hand},
          {"uptime_s", status.uptime_s},
          {"workers", status.workers},
          {"running", status.running},
          {"queue_length", status.queue_length},
          {"queue_capacity", status.queue_capacity},
          {"overloaded", status.overloaded != 0},
          {"active", status.active},
          {"outcomes", outcomes},
          {"repeated", status.repeated},
          {"superseded", status.superseded},
          {"refused", status.refused},
          {"latency_s",
           {{"p50", status.latency_p50_s}, {"p90", status.latency_p90_s}, {"p99", status.latency_p99_s}}},
          {"receive_buffer_bytes",
           {{"asked", status.receive_buffer_asked}, {"granted", status.receive_buffer_granted}}}};
}

std::map<std::string, double> metricsOf(const model_info_t& model) {
  std::map<std::string, double> metrics;
  for (const metric_t& metric : model.metrics) metrics[metric.name] = metric.value;
  return metrics;
}

nlohmann::ordered_json modelJson(const model_info_t& model) {
  return {{"version", model.version},
          {"name", model.name},
          {"state", model.state},
          {"reason", model.reason},
          {"serving", model.serving != 0},
          {"pinned", model.pinned != 0},
          {"key", model.key},
          {"accepted", model.accepted},
          {"created", model.created},
          {"trained_on", model.trained_on},
          {"command", model.command},
          {"data_hash", model.data_hash},
          {"seed", model.seed},
          {"features", model.features},
          {"shape", model.shape},
          {"metrics", metricsOf(model)}};
}

nlohmann::ordered_json trainingJson(const training_status_t& training) {
  return {{"worker", training.worker},
          {"state", stateName(training.state)},
          {"cause", training.cause},
          {"stage", training.stage},
          {"progress", training.progress},
          {"remaining_s", training.remaining_s},
          {"labels", training.labels},
          {"outcomes", training.outcomes},
          {"outcomes_waiting", training.outcomes_waiting},
          {"candidate", training.candidate},
          {"published", training.published != 0},
          {"message", training.message}};
}

}  // namespace boxgrasp
