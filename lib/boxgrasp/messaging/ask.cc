#include "boxgrasp/messaging/ask.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <optional>

#include "boxgrasp/base/error.h"
#include "boxgrasp/messaging/channels.h"
#include "boxgrasp/messaging/plan_conversion.h"

namespace boxgrasp {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kStatusPatience_s =
    5.0;  // the server says how it is once a second, and LCM may lose a few of them
constexpr int kTick_ms = 50;
constexpr std::chrono::milliseconds kPause{1500};  // before the question is sent again
constexpr std::size_t kSafeBytes = 100'000;        // fits any kernel's default receive buffer

// The state of one ask().
class Asking {
 public:
  Asking(const AskOptions& options, LcmBus::Bytes question, const std::string& answer_channel,
         const std::function<bool(LcmBus::Bytes)>& take)
      : options_(options), question_(question), bus_({.url = options.lcm_url}) {
    bus_.subscribe(channel::kStatus, kMaxMessageBytes,
                   [this](LcmBus::Bytes bytes) { status_ = decoded<status_t>(bytes); });
    bus_.subscribe(answer_channel, kMaxMessageBytes,
                   [this, &take](LcmBus::Bytes bytes) { answered_ = answered_ || take(bytes); });
  }

  void run(const std::string& channel) {
    if (question_.size() > kSafeBytes) waitForServer();
    for (auto next = Clock::now(); !answered_; bus_.wait(kTick_ms)) {
      giveUpIfLate();
      if (Clock::now() < next) continue;
      bus_.publish(channel, question_);
      next = Clock::now() + kPause;
    }
  }

 private:
  double waited_s() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  void waitForServer() {
    for (; !status_; bus_.wait(kTick_ms)) giveUpIfLate();
    const std::int64_t granted = status_->receive_buffer_granted;
    if (granted >= 0 && static_cast<std::int64_t>(question_.size()) > granted)
      throw InputError(fmt::format(
          "the message takes {0} bytes, but the server's receive buffer holds {1}, and LCM loses messages "
          "that "
          "do not fit; raise it on the server's machine (sysctl -w net.core.rmem_max={0}, then restart the "
          "server), or use a tcpq:// broker",
          question_.size(), granted));
  }

  void giveUpIfLate() const {
    if (!status_ && waited_s() > kStatusPatience_s)
      throw NotReachable(
          fmt::format("no boxgrasp-server answers on '{0}'; start one (boxgrasp-server --lcm-url '{0}'), or "
                      "give the URL of "
                      "one with --lcm-url",
                      options_.lcm_url));
    if (waited_s() > std::max(options_.timeout_s, kStatusPatience_s))
      throw NoAnswer(
          fmt::format("no answer after {:.1f} s; see what the server's log says, and try again", waited_s()));
  }

  const AskOptions& options_;
  const LcmBus::Bytes question_;
  const Clock::time_point start_ = Clock::now();
  LcmBus bus_;
  std::optional<status_t> status_;
  bool answered_ = false;
};

}  // namespace

std::string newRequestId() {
  char host[65] = {};
  gethostname(host, sizeof host - 1);
  return fmt::format("{}-{}-{}", host, getpid(), utimeNow());
}

void ask(const AskOptions& options, const std::string& channel, LcmBus::Bytes question,
         const std::string& answer_channel, const std::function<bool(LcmBus::Bytes)>& take) {
  Asking(options, question, answer_channel, take).run(channel);
}

}  // namespace boxgrasp
