// The server, as the client sees it.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "boxgrasp/messaging/ask.h"
#include "boxgrasp/planning/plan.h"

namespace boxgrasp {

struct RemotePlan {
  PlanRequest request;
  std::string frame;
  double deadline_s =
      0.0;  // 0: none given; the server has its own, and the client gives up after kPatience_s
  std::string request_id = {};  // empty: a new one
};

// One server on one bus. Says on stderr what it waits for.
class Remote {
 public:
  static constexpr double kPatience_s = 120.0;

  explicit Remote(const std::string& lcm_url);

  // Sends the request, again with the same id while no answer comes and the server does not have it, until
  // the deadline. Ctrl-C cancels it on the server. Throws InputError for a cloud that the server's socket
  // cannot take, NotReachable, NoAnswer, TransportError.
  plan_response_t plan(const RemotePlan& plan);

  // The next status. Throws NotReachable when none comes.
  status_t status();

 private:
  using Clock = std::chrono::steady_clock;

  void waitForServer();
  void checkSize(std::size_t bytes) const;
  void send();
  void resendIfLost();
  void cancel();
  void giveUpIfLate(double patience_s) const;
  bool serverHasIt() const;

  std::string lcm_url_, request_id_;
  LcmBus bus_;
  std::optional<status_t> status_;
  std::optional<plan_response_t> answer_;
  std::vector<std::uint8_t> request_;  // encoded
  Clock::time_point start_, next_send_;
  std::chrono::milliseconds pause_{};  // before the request is sent again
};

}  // namespace boxgrasp
