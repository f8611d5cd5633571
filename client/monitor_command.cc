#include "monitor_command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <map>
#include <optional>

#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/messaging/lcm_url.h"
#include "boxgrasp/messaging/packet_watch.h"
#include "interruption.h"
#include "message_text.h"
#include "plan_json.h"

namespace boxgrasp {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kTick_ms = 50;
constexpr double kOnce_s = 2.5;  // in which a server's status, once a second, is heard twice

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct ChannelCount {
  std::int64_t messages = 0, bytes = 0, last_bytes = 0;
  Clock::time_point last{};
  double rate_hz = NAN, bytes_per_s = NAN;             // over the last second or so
  std::int64_t messages_before = 0, bytes_before = 0;  // where that began
  MessageText latest;
};

class Monitor {
 public:
  explicit Monitor(const MonitorCommand& command)
      : command_(command),
        bus_({.url = command.lcm_url}),
        lines_(!command.once && !command.json && !isatty(STDOUT_FILENO)) {
    if (multicastAddress(command.lcm_url)) watch_.emplace(command.lcm_url);
    for (const std::string& names : command.channels)
      bus_.listen(names, [this](const LcmBus::Heard& heard) { take(heard); });
  }

  int run() {
    const Interruption interruption;
    const double end_s = command_.seconds > 0 ? command_.seconds : command_.once ? kOnce_s : INFINITY;
    while (!interruption.asked() && secondsSince(start_) < end_s) {
      bus_.wait(kTick_ms);
      if (watch_) watch_->read();
      if (secondsSince(drawn_) >= 1.0) refresh();
    }
    if (command_.once) {
      update();
      show();
    }
    if (channels_.empty())
      fmt::print(stderr, "boxgrasp: nothing was said on {}\n", fmt::join(command_.channels, ", "));
    return channels_.empty() ? kNothingFound : kDone;
  }

 private:
  void take(const LcmBus::Heard& heard) {
    ChannelCount& count = channels_[heard.channel];
    ++count.messages;
    count.last_bytes = static_cast<std::int64_t>(heard.bytes.size());
    count.bytes += count.last_bytes;
    count.last = Clock::now();
    count.latest = describe(heard.bytes);
    if (!lines_) return;
    fmt::print("{:.6f}  {:<24}  {:>9}  {}\n", 1e-6 * static_cast<double>(heard.utime), heard.channel,
               bytesText(static_cast<double>(heard.bytes.size())), count.latest.summary);
    std::fflush(stdout);
  }

  void update() {
    const double passed_s = secondsSince(drawn_);
    for (auto& [name, count] : channels_) {
      count.rate_hz = static_cast<double>(count.messages - count.messages_before) / passed_s;
      count.bytes_per_s = static_cast<double>(count.bytes - count.bytes_before) / passed_s;
      if (command_.once) continue;  // over the whole time
      count.messages_before = count.messages;
      count.bytes_before = count.bytes;
    }
  }

  void refresh() {
    if (command_.once || lines_) return;
    update();
    drawn_ = Clock::now();
    show();
  }

  void show() const {
    constexpr char kHomeAndClear[] = "\x1b[H\x1b[J";
    if (command_.json)
      fmt::print("{}\n", json().dump(-1, ' ', false, Json::error_handler_t::replace));
    else
      fmt::print("{}{}", command_.once ? "" : kHomeAndClear, table());
    std::fflush(stdout);
  }

  std::string table() const {
    std::string text = fmt::format("{:<26}{:>9}{:>9}{:>12}{:>10}{:>8}  {}\n", "channel", "messages", "per s",
                                   "per s", "last", "ago", "latest");
    for (const auto& [name, count] : channels_)
      text +=
          fmt::format("{:<26}{:>9}{:>9.1f}{:>12}{:>10}{:>6.1f} s  {}\n", name, count.messages, count.rate_hz,
                      bytesText(count.bytes_per_s), bytesText(static_cast<double>(count.last_bytes)),
                      secondsSince(count.last), count.latest.summary);
    if (!watch_) return text;
    text += fmt::format("\n{:<26}{:>9}{:>9}{:>12}\n", "sender, on all channels", "messages", "lost",
                        "incomplete");
    for (const auto& [sender, count] : watch_->counter().senders())
      text += fmt::format("{:<26}{:>9}{:>9}{:>12}\n", sender, count.messages, count.lost, count.incomplete);
    return text;
  }

  Json json() const {
    Json channels = Json::array(), senders = Json::array();
    for (const auto& [name, count] : channels_)
      channels.push_back({{"channel", name},
                          {"messages", count.messages},
                          {"rate_hz", count.rate_hz},
                          {"bytes_per_s", count.bytes_per_s},
                          {"last_bytes", count.last_bytes},
                          {"age_s", secondsSince(count.last)},
                          {"type", count.latest.type},
                          {"latest", count.latest.summary}});
    if (watch_) {
      for (const auto& [sender, count] : watch_->counter().senders())
        senders.push_back({{"sender", sender},
                           {"messages", count.messages},
                           {"lost", count.lost},
                           {"incomplete", count.incomplete}});
    }
    return {{"schema", 1}, {"time_s", secondsSince(start_)}, {"channels", channels}, {"senders", senders}};
  }

  const MonitorCommand& command_;
  LcmBus bus_;
  std::optional<PacketWatch> watch_;  // beside udpm alone
  const bool lines_;
  std::map<std::string, ChannelCount> channels_;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point drawn_ = start_;
};

}  // namespace

int runMonitor(const MonitorCommand& command) { return Monitor(command).run(); }

}  // namespace boxgrasp
