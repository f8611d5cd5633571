#include "message_text.h"

#include <fmt/format.h>

#include <array>
#include <functional>

#include "boxgrasp/base/error.h"
#include "boxgrasp/messaging/plan_conversion.h"

namespace boxgrasp {
namespace {

std::string text(const drake::lcmt_point_cloud& m) {
  return fmt::format("{} points in frame '{}'", m.width * m.height, m.frame_name);
}
std::string text(const plan_request_t& m) { return fmt::format("{}: {}", m.request_id, text(m.cloud)); }
std::string text(const plan_response_t& m) {
  return fmt::format("{}: {}: {}", m.request_id, outcomeName(m.outcome), m.message);
}
std::string text(const cancel_t& m) { return m.request_id; }
std::string text(const status_t& m) {
  return fmt::format("up {:.0f} s, model {}, {} of {} workers busy, {} of {} waiting", m.uptime_s,
                     m.model_version, m.running, m.workers, m.queue_length, m.queue_capacity);
}
std::string text(const publish_model_t& m) {
  return fmt::format("{}: a model of {} bytes", m.request_id, m.model_size);
}
std::string text(const model_reply_t& m) { return fmt::format("{}: {}", m.version, m.message); }
std::string text(const models_request_t& m) {
  constexpr std::array kOrders{"list", "pin", "unpin", "roll back"};
  const bool known = m.action >= 0 && m.action < static_cast<int>(kOrders.size());
  return fmt::format("{} {}", known ? kOrders[m.action] : "unknown order", m.version);
}
std::string text(const models_reply_t& m) { return fmt::format("{} models; {}", m.num_models, m.message); }
std::string text(const grasp_outcome_t& m) {
  return fmt::format("{}, grasp {} {} ({})", m.request_id, m.grasp_index,
                     m.succeeded ? "succeeded" : "failed", m.robot);
}
std::string text(const outcome_reply_t& m) {
  return fmt::format("{}, grasp {}: {}", m.request_id, m.grasp_index, m.message);
}
std::string text(const retrain_request_t& m) {
  return fmt::format("{}{}: {}", m.cancel ? "stop " : "", m.request_id, m.reason);
}
std::string text(const training_status_t& m) {
  return m.state == training_status_t::IDLE
             ? fmt::format("{}: idle, {} outcomes wait", m.worker, m.outcomes_waiting)
             : fmt::format("{}: {}, {:.0f} %", m.worker, m.stage, 100 * m.progress);
}

struct Kind {
  const char* type;
  std::uint64_t fingerprint;
  std::function<std::string(LcmBus::Bytes)> summary;
};

template <typename Message>
Kind kind(const char* type) {
  return {type, wireFingerprint(layoutOf<Message>()),
          [](LcmBus::Bytes bytes) { return text(decoded<Message>(bytes)); }};
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{kind<drake::lcmt_point_cloud>("drake.lcmt_point_cloud"),
                                     kind<plan_request_t>("boxgrasp.plan_request_t"),
                                     kind<plan_response_t>("boxgrasp.plan_response_t"),
                                     kind<cancel_t>("boxgrasp.cancel_t"),
                                     kind<status_t>("boxgrasp.status_t"),
                                     kind<publish_model_t>("boxgrasp.publish_model_t"),
                                     kind<model_reply_t>("boxgrasp.model_reply_t"),
                                     kind<models_request_t>("boxgrasp.models_request_t"),
                                     kind<models_reply_t>("boxgrasp.models_reply_t"),
                                     kind<grasp_outcome_t>("boxgrasp.grasp_outcome_t"),
                                     kind<outcome_reply_t>("boxgrasp.outcome_reply_t"),
                                     kind<retrain_request_t>("boxgrasp.retrain_request_t"),
                                     kind<training_status_t>("boxgrasp.training_status_t")};
  return all;
}

std::uint64_t fingerprintOf(LcmBus::Bytes bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8 && i < bytes.size(); ++i) value = value << 8 | bytes[i];
  return value;
}

// In one line, whatever somebody sent.
std::string printable(std::string line) {
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7f) c = ' ';
  }
  return line;
}

}  // namespace

MessageText describe(LcmBus::Bytes bytes) {
  const std::uint64_t fingerprint = fingerprintOf(bytes);
  for (const Kind& kind : kinds()) {
    if (kind.fingerprint != fingerprint) continue;
    try {
      return {kind.type, printable(kind.summary(bytes))};
    } catch (const InputError& error) {
      return {kind.type, fmt::format("damaged: {}", printable(error.what()))};
    }
  }
  return {"", fmt::format("no type of this version of Boxgrasp (fingerprint {:016x})", fingerprint)};
}

std::string bytesText(double bytes) {
  constexpr std::array kUnits{"B", "kB", "MB", "GB"};
  std::size_t unit = 0;
  for (; bytes >= 1024 && unit + 1 < kUnits.size(); ++unit) bytes /= 1024;
  return fmt::format("{:.{}f} {}", bytes, unit == 0 || bytes >= 100 ? 0 : 1, kUnits[unit]);
}

}  // namespace boxgrasp
