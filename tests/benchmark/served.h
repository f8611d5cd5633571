// A server as a process, with a client that speaks the wire itself, and what it takes of the machine.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <stdexcept>

#include "processes.h"
#include "wire.h"

namespace boxgrasp::test {

// The value below which this share of the values lies; NaN without any.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}
inline double median(const std::vector<double>& values) { return quantile(values, 0.5); }

// A line of /proc/PID/status, such as VmHWM, VmRSS (kB) or Threads; NaN when there is none.
inline double processStatus(pid_t process, const std::string& line) {
  std::ifstream stream(fmt::format("/proc/{}/status", process));
  for (std::string word; stream >> word;) {
    double value = 0;
    if (word == line + ":" && stream >> value) return value;
  }
  return NAN;
}

class Served {
 public:
  Served(const fs::path& program, const std::string& toml, const std::vector<std::string>& more = {}) {
    std::ofstream(folder_ / "server.toml") << toml;
    std::vector<std::string> arguments{program, "--lcm-url", url(), "--config", folder_ / "server.toml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    server_.emplace(arguments);
    if (!wire.until([&] { return wire.status.utime != 0; }, 15.0))
      throw std::runtime_error("the server does not start: " + server_->err());
  }

  // A new one each time.
  plan_request_t request(const PointCloud& cloud) {
    PlanRequest plan;
    plan.cloud_C = cloud;
    return toMessage(plan, {newId(), "camera", 0.0, 1});
  }
  std::string newId() { return fmt::format("request-{}", ++requests_); }
  // Sends the request and waits for its answer, which counts as one of the last.
  plan_response_t plan(const plan_request_t& message) {
    wire.answers.clear();
    wire.raw.clear();
    const auto* answer = wire.ask(message);
    if (answer == nullptr) throw std::runtime_error("no answer came; the server says: " + server_->err());
    return *answer;
  }

  Process& process() { return *server_; }
  // Its receiving process; 0 while there is none.
  pid_t receiver() const {
    pid_t child = 0;
    std::ifstream(fmt::format("/proc/{0}/task/{0}/children", server_->id())) >> child;
    return child;
  }
  double memory_mb(const std::string& line) const { return processStatus(server_->id(), line) / 1024; }

  Wire wire;

 private:
  TemporaryFolder folder_;
  std::optional<Process> server_;
  int requests_ = 0;
};

}  // namespace boxgrasp::test
