#include "doctor_command.h"

#include <fmt/color.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "boxgrasp/base/error.h"
#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/messaging/ask.h"
#include "boxgrasp/messaging/channels.h"
#include "boxgrasp/messaging/lcm_url.h"
#include "boxgrasp/messaging/plan_conversion.h"
#include "boxgrasp/planning/default_model.h"
#include "boxgrasp/registry/canary.h"
#include "boxgrasp/registry/signing.h"
#include "plan_json.h"

namespace boxgrasp {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kPatience_s = 3.0;  // the server says how it is once a second
constexpr int kTick_ms = 50;
constexpr double kClockApart_s = 1.0, kClockWrong_s = 300.0;  // orders to a server are refused beyond
constexpr std::uintmax_t kLittleSpace_bytes = 200u << 20;     // models and outcomes take a few MB a day

enum class Grade { ok, warn, fail };

struct Check {
  std::string name;
  Grade grade = Grade::ok;
  std::string finding, remedy;  // the remedy is empty when there is nothing to mend
};

constexpr const char* nameOf(Grade grade) {
  return grade == Grade::ok ? "ok" : grade == Grade::warn ? "warn" : "fail";
}

// What is said on the bus within the patience.
struct Heard {
  bool own_message = false;
  std::optional<status_t> status;
  double clock_apart_s = NAN;  // the server's clock before this machine's
  ReceiveBuffer buffer;        // of this process
};

Heard listen(const std::string& lcm_url) {
  constexpr char kOwnChannel[] = "BOXGRASP_DOCTOR";
  Heard heard;
  LcmBus bus({.url = lcm_url});
  heard.buffer = bus.receiveBuffer();
  bus.subscribe(kOwnChannel, kMaxTextBytes, [&](LcmBus::Bytes) { heard.own_message = true; });
  bus.subscribe(channel::kStatus, kMaxMessageBytes, [&](LcmBus::Bytes bytes) {
    heard.status = decoded<status_t>(bytes);
    heard.clock_apart_s = 1e-6 * static_cast<double>(heard.status->utime - utimeNow());
  });
  const std::array<std::uint8_t, 4> hello{};
  for (const auto late = Clock::now() + std::chrono::duration<double>(kPatience_s); Clock::now() < late;) {
    if (!heard.own_message) bus.publish(kOwnChannel, hello);
    if (heard.own_message && heard.status) break;
    bus.wait(kTick_ms);
  }
  return heard;
}

Check checkTransport(const std::string& lcm_url, std::optional<Heard>& heard) try {
  const auto multicast = multicastAddress(lcm_url);
  const std::string obstacle = multicast ? multicastObstacle(*multicast) : "";
  if (!obstacle.empty()) return {"multicast", Grade::fail, lcm_url, obstacle};
  heard = listen(lcm_url);
  if (!heard->own_message)
    return {"multicast", Grade::fail, fmt::format("what is sent to {} does not come back", lcm_url),
            "let UDP multicast through this machine's firewall (deploy/firewall.nft is an example), or use a "
            "tcpq:// broker"};
  return {"multicast", Grade::ok, fmt::format("what is sent to {} comes back", lcm_url), ""};
} catch (const std::exception& error) {
  return {"multicast", Grade::fail, error.what(), "give another address with --lcm-url"};
}

// What a program that is not root's is granted; root's is bound by nothing.
std::int64_t grantedToUsers(const ReceiveBuffer& buffer) {
  std::int64_t most = 0;
  return std::ifstream("/proc/sys/net/core/rmem_max") >> most ? std::min(most, buffer.granted)
                                                              : buffer.granted;
}

Check checkBuffer(const Heard& heard) {
  const bool servers = heard.status.has_value();
  const std::int64_t asked = servers ? heard.status->receive_buffer_asked : heard.buffer.asked,
                     granted = servers ? heard.status->receive_buffer_granted : grantedToUsers(heard.buffer);
  const char* whose = servers ? "the server's" : "this machine's";
  if (asked < 0) return {"receive buffer", Grade::ok, "this transport needs none", ""};
  const std::string finding =
      fmt::format("{} holds {} bytes: clouds of {} points", whose, granted, granted / 12);
  if (granted >= asked) return {"receive buffer", Grade::ok, finding, ""};
  return {"receive buffer", Grade::warn, finding + " at most; larger ones get lost",
          fmt::format(
              "sysctl -w net.core.rmem_max={} there, the same line in /etc/sysctl.d/boxgrasp.conf for good, "
              "then restart the server",
              asked)};
}

Check checkServer(const Heard& heard, const std::string& lcm_url) {
  if (!heard.status)
    return {
        "server", Grade::fail, fmt::format("none answers on {} within {} s", lcm_url, kPatience_s),
        fmt::format("start one (systemctl start boxgrasp-server, or boxgrasp-server --lcm-url '{}'), or give "
                    "the address of one with --lcm-url; between machines both need ttl=1",
                    lcm_url)};
  const status_t& status = *heard.status;
  const std::string finding =
      fmt::format("version {}, model {}, hand {}, {} of {} workers busy", status.version,
                  status.model_version, status.hand, status.running, status.workers);
  if (status.version != BOXGRASP_VERSION)
    return {"server", Grade::warn, finding,
            "this client is version " BOXGRASP_VERSION "; install one version on both"};
  if (status.overloaded)
    return {"server", Grade::warn, finding + "; its queue is full",
            "more workers (server.workers), or fewer requests at a time"};
  return {"server", Grade::ok, finding, ""};
}

Check checkClock(const Heard& heard) {
  constexpr char kRemedy[] = "keep both clocks by NTP: apt install chrony; chronyc tracking shows how it is";
  if (!heard.status)
    return {"clock", Grade::warn, "not compared: no server answers", "mend the server first"};
  const double apart_s = std::abs(heard.clock_apart_s);
  const std::string finding = fmt::format("{:.3f} s apart from the server's", apart_s);
  if (apart_s < kClockApart_s) return {"clock", Grade::ok, finding, ""};
  return {"clock", apart_s < kClockWrong_s ? Grade::warn : Grade::fail,
          finding + "; orders to it need fresh stamps", kRemedy};
}

Check checkModel(const std::optional<fs::path>& file) try {
  const Model model = modelOrDefault(file, barrettHand());
  runCanary(model);
  return {"model", Grade::ok,
          fmt::format("{} {} ({}) scores the canary grasps", file ? file->string() : "the built-in",
                      model.version, model.name),
          ""};
} catch (const std::exception& error) {
  return {"model", Grade::fail, error.what(),
          "take another with --model, or train one: boxgrasp-trainer train"};
}

constexpr char kAsItsUser[] = "look as root, or as the server's user: sudo -u boxgrasp boxgrasp doctor";

Check checkKeys(const fs::path& folder) try {
  std::error_code error;
  if (!fs::exists(folder, error)) {
    if (error)
      return {"keys", Grade::warn, fmt::format("'{}': {}", folder.string(), error.message()), kAsItsUser};
    return {"keys", Grade::warn, fmt::format("there is no '{}': nobody may publish models", folder.string()),
            "boxgrasp-trainer keygen --out lab.key, and copy lab.key.pub there; or name the folder with "
            "--trusted-keys"};
  }
  if (TrustedKeys(folder).empty())
    return {"keys", Grade::warn, fmt::format("'{}' is empty: nobody may publish models", folder.string()),
            "boxgrasp-trainer keygen --out lab.key, and copy lab.key.pub there"};
  return {"keys", Grade::ok, fmt::format("those in '{}' may publish models", folder.string()), ""};
} catch (const std::exception& error) {
  return {"keys", Grade::fail, error.what(),
          "remove the file, or put a key of boxgrasp-trainer keygen there"};
}

// What is damaged in the state folder; empty: nothing that can be seen from outside.
std::string damageIn(const fs::path& folder) {
  const fs::path outcomes = folder / "outcomes.db", registry = folder / "models" / "registry.json";
  std::string head(15, '\0');
  std::ifstream(outcomes, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
  if (fs::exists(outcomes) && fs::file_size(outcomes) > 0 && head != "SQLite format 3")
    return outcomes.string();
  if (fs::exists(registry) && !nlohmann::json::accept(std::ifstream(registry))) return registry.string();
  return "";
}

Check checkStore(const fs::path& folder) try {
  std::error_code error;
  if (!fs::exists(folder, error) && !error)
    return {"store", Grade::warn,
            fmt::format("there is no '{}': no model or outcome is kept", folder.string()),
            "start the service once, or name its folder with --state-dir"};
  if (error || access(folder.c_str(), R_OK | W_OK | X_OK) != 0)
    return {"store", Grade::warn, fmt::format("'{}' is not this user's", folder.string()), kAsItsUser};
  if (const std::string damaged = damageIn(folder); !damaged.empty())
    return {"store", Grade::fail, fmt::format("'{}' is damaged", damaged),
            "stop the server, move the file away, start it again: it begins a new one"};
  const std::uintmax_t free = fs::space(folder).available;
  const std::string finding = fmt::format("'{}' is sound, {} MB free", folder.string(), free >> 20);
  if (free >= kLittleSpace_bytes) return {"store", Grade::ok, finding, ""};
  return {"store", free == 0 ? Grade::fail : Grade::warn, finding, "make room on that disk"};
} catch (const std::exception& error) {
  return {"store", Grade::warn, error.what(), kAsItsUser};
}

std::vector<Check> examine(const DoctorCommand& command, const std::string& lcm_url) {
  std::optional<Heard> heard;
  std::vector<Check> checks = {checkTransport(lcm_url, heard)};
  const Heard nothing;
  const Heard& known = heard ? *heard : nothing;
  if (heard) checks.push_back(checkBuffer(known));
  checks.push_back(checkServer(known, lcm_url));
  checks.push_back(checkClock(known));
  checks.push_back(checkModel(command.model));
  checks.push_back(checkKeys(command.trusted_keys));
  checks.push_back(checkStore(command.state_dir));
  return checks;
}

void print(const Check& check) {
  static const bool colours = isatty(STDOUT_FILENO);
  const auto colour = check.grade == Grade::ok     ? fmt::terminal_color::green
                      : check.grade == Grade::warn ? fmt::terminal_color::yellow
                                                   : fmt::terminal_color::red;
  const std::string grade = fmt::format("{:<4}", nameOf(check.grade));
  fmt::print("{}  {:<14}  {}\n", colours ? fmt::format(fg(colour), "{}", grade) : grade, check.name,
             check.finding);
  if (!check.remedy.empty()) fmt::print("      {:<14}  -> {}\n", "", check.remedy);
}

Json jsonOf(const std::vector<Check>& checks, bool healthy) {
  Json list = Json::array();
  for (const Check& check : checks)
    list.push_back({{"name", check.name},
                    {"grade", nameOf(check.grade)},
                    {"finding", check.finding},
                    {"remedy", check.remedy}});
  return {{"schema", 1}, {"healthy", healthy}, {"checks", list}};
}

}  // namespace

int runDoctor(const DoctorCommand& command, const std::string& lcm_url, bool json) {
  const std::vector<Check> checks = examine(command, lcm_url);
  const bool healthy =
      std::none_of(checks.begin(), checks.end(), [](const Check& c) { return c.grade == Grade::fail; });
  if (json)
    fmt::print("{}\n", jsonText(jsonOf(checks, healthy)));
  else
    for (const Check& check : checks) print(check);
  return healthy ? kDone : kNothingFound;
}

}  // namespace boxgrasp
