#include "boxgrasp/live/metrics.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "boxgrasp/messaging/plan_conversion.h"

namespace boxgrasp {
namespace {

using Labels = std::vector<std::pair<std::string, std::string>>;

std::string escaped(const std::string& value) {
  std::string text;
  for (const char c : value) {
    if (c == '\\' || c == '"') text += '\\';
    text += c == '\n' ? "\\n" : std::string(1, c);
  }
  return text;
}

std::string number(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
  return fmt::format("{}", value);
}

class Text {
 public:
  void head(const char* name, const char* type, const char* help) {
    text_ += fmt::format("# HELP boxgrasp_{0} {1}\n# TYPE boxgrasp_{0} {2}\n", name, help, type);
  }
  void sample(const std::string& name, double value, const Labels& labels = {}) {
    std::string inside;
    for (const auto& [label, text] : labels)
      inside += fmt::format("{}{}=\"{}\"", inside.empty() ? "" : ",", label, escaped(text));
    text_ += fmt::format("boxgrasp_{}{} {}\n", name, inside.empty() ? "" : "{" + inside + "}", number(value));
  }
  void one(const char* name, const char* type, const char* help, double value, const Labels& labels = {}) {
    head(name, type, help);
    sample(name, value, labels);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

void addRequests(Text& text, const status_t& status) {
  text.head("requests_total", "counter", "Answers given, by outcome.");
  for (std::int8_t outcome = 0; outcome < static_cast<int>(std::size(status.outcomes)); ++outcome)
    text.sample("requests_total", static_cast<double>(status.outcomes[outcome]),
                {{"outcome", std::string(outcomeName(outcome))}});
  text.one("requests_repeated_total", "counter", "Requests answered again from memory.",
           static_cast<double>(status.repeated));
  text.one("clouds_superseded_total", "counter", "Clouds that a later one replaced before they were planned.",
           static_cast<double>(status.superseded));
  text.one("messages_refused_total", "counter", "Messages that are not what their channel carries.",
           static_cast<double>(status.refused));
}

void addLatencies(Text& text, const LatencyCounts& latencies) {
  constexpr char kName[] = "request_duration_seconds";
  text.head(kName, "histogram", "From a request's arrival to its answer.");
  double count = 0;
  for (std::size_t i = 0; i < latencies.counts().size(); ++i) {
    count += static_cast<double>(latencies.counts()[i]);
    const double bound = i < LatencyCounts::kBounds_s.size() ? LatencyCounts::kBounds_s[i] : INFINITY;
    text.sample(fmt::format("{}_bucket", kName), count, {{"le", number(bound)}});
  }
  text.sample(fmt::format("{}_sum", kName), latencies.sum_s());
  text.sample(fmt::format("{}_count", kName), count);
}

void addGauges(Text& text, const status_t& status) {
  const auto gauge = [&](const char* name, const char* help, double value) {
    text.one(name, "gauge", help, value);
  };
  gauge("queue_length", "Requests that wait.", status.queue_length);
  gauge("queue_capacity", "Requests that may wait.", status.queue_capacity);
  gauge("running", "Plans that run.", status.running);
  gauge("workers", "Plans that may run at the same time.", status.workers);
  gauge("overloaded", "1 while the next request would be refused.", status.overloaded);
  gauge("uptime_seconds", "Since the server was ready.", status.uptime_s);
  gauge("receive_buffer_asked_bytes", "Receive buffer that was asked for; -1: none.",
        static_cast<double>(status.receive_buffer_asked));
  gauge("receive_buffer_granted_bytes", "Receive buffer that was granted; larger messages can get lost.",
        static_cast<double>(status.receive_buffer_granted));
}

void addProcess(Text& text, const ServerState& state) {
  text.one("receiver_restarts_total", "counter", "Receiving processes that had to be replaced.",
           static_cast<double>(state.receiver_restarts));
  text.one("resident_memory_bytes", "gauge", "Memory of the server; -1: unknown.",
           static_cast<double>(state.resident_bytes));
  text.one("build_info", "gauge", "1, with the server's version.", 1, {{"version", state.status.version}});
  text.one("model_info", "gauge", "1, with the model in service and the hand.", 1,
           {{"version", state.status.model_version}, {"hand", state.status.hand}});
}

void addTraining(Text& text, const training_status_t& training) {
  const Labels worker = {{"worker", training.worker}};
  text.one("training_active", "gauge", "1 while the background worker trains.",
           training.state != training_status_t::IDLE, worker);
  text.one("training_progress", "gauge", "Of the training that runs, 0 to 1; NaN when idle.",
           training.progress, worker);
  text.one("training_outcomes_waiting", "gauge", "Outcomes that came since the last training.",
           static_cast<double>(training.outcomes_waiting), worker);
}

}  // namespace

std::string metricsText(const ServerState& state, const std::optional<training_status_t>& training) {
  Text text;
  addRequests(text, state.status);
  addLatencies(text, state.latencies);
  addGauges(text, state.status);
  addProcess(text, state);
  if (training) addTraining(text, *training);
  return text.take();
}

}  // namespace boxgrasp
