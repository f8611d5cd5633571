#include "log_commands.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <optional>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/messaging/event_log.h"
#include "boxgrasp/messaging/lcm_bus.h"
#include "interruption.h"
#include "message_text.h"
#include "plan_json.h"

namespace boxgrasp {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kTick_ms = 50;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

int conclude(const LogCommand& command, const std::string& done, std::int64_t messages, std::int64_t bytes) {
  if (command.json)
    fmt::print("{}\n",
               jsonText({{"schema", 1}, {"file", command.file}, {"messages", messages}, {"bytes", bytes}}));
  else
    fmt::print("{} messages {} ({})\n", messages, done, bytesText(static_cast<double>(bytes)));
  return messages > 0 ? kDone : kNothingFound;
}

bool isChosen(const LogCommand& command, const std::string& channel) {
  return std::ranges::any_of(command.channels, [&](const std::string& names) {
    return fnmatch(names.c_str(), channel.c_str(), 0) == 0;
  });
}

// Waits until it is the event's turn; false if the user ends it before.
bool waitUntil(double due_s, Clock::time_point start, LcmBus& bus, const Interruption& interruption) {
  while (!interruption.asked()) {
    const double left_s = due_s - secondsSince(start);
    if (left_s <= 0) return true;
    bus.wait(static_cast<int>(std::ceil(1e3 * std::min(left_s, 1e-3 * kTick_ms))));
  }
  return false;
}

}  // namespace

int runRecord(const LogCommand& command) {
  const Interruption interruption;
  LcmBus bus({.url = command.lcm_url});
  EventLogWriter log(command.file);
  std::exception_ptr problem;  // of the disk; LCM lets no exception through
  for (const std::string& names : command.channels) {
    bus.listen(names, [&](const LcmBus::Heard& heard) {
      try {
        if (!problem) log.write(heard.channel, heard.utime, heard.bytes);
      } catch (const InputError&) {
        problem = std::current_exception();
      }
    });
  }
  fmt::print(stderr, "boxgrasp: recording {} into {}\n", fmt::join(command.channels, ", "),
             command.file.string());
  const auto start = Clock::now();
  while (!problem && !interruption.asked() && (command.seconds <= 0 || secondsSince(start) < command.seconds))
    bus.wait(kTick_ms);
  if (problem) std::rethrow_exception(problem);
  return conclude(command, "recorded", log.events(), log.bytes());
}

int runReplay(const LogCommand& command) {
  const Interruption interruption;
  EventLogReader log(command.file);
  LcmBus bus({.url = command.lcm_url});
  const auto start = Clock::now();
  std::int64_t messages = 0, bytes = 0;
  std::optional<std::int64_t> first_utime;
  while (const std::optional<LogEvent> event = log.next()) {
    if (!isChosen(command, event->channel)) continue;
    if (!first_utime) first_utime = event->utime;
    const double due_s = 1e-6 * static_cast<double>(event->utime - *first_utime) / command.speed;
    if (!waitUntil(due_s, start, bus, interruption)) break;
    bus.publish(event->channel, event->data);
    ++messages;
    bytes += static_cast<std::int64_t>(event->data.size());
  }
  if (log.cutOff())
    fmt::print(stderr, "boxgrasp: the last message of {} is cut off\n", command.file.string());
  return conclude(command, "replayed", messages, bytes);
}

}  // namespace boxgrasp
