#include "remote.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "boxgrasp/base/error.h"
#include "boxgrasp/messaging/channels.h"
#include "boxgrasp/messaging/plan_conversion.h"
#include "interruption.h"

namespace boxgrasp {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kStatusPatience_s = 3.0;  // the server says how it is once a second
constexpr double kGrace_s = 1.0;           // beyond the deadline, for an answer that says that it passed
constexpr int kTick_ms = 50;
constexpr std::chrono::milliseconds kFirstPause{1500},
    kLongestPause{8000};                     // longer than from status to status
constexpr std::size_t kSafeBytes = 100'000;  // fits any kernel's default receive buffer

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

[[noreturn]] void failNotReachable(const std::string& lcm_url) {
  throw NotReachable(fmt::format(
      "no boxgrasp-server answers on '{0}'; start one (boxgrasp-server --lcm-url '{0}'), give the URL of one "
      "with --lcm-url, or plan without a server: --local",
      lcm_url));
}

}  // namespace

Remote::Remote(const std::string& lcm_url) : lcm_url_(lcm_url), bus_({.url = lcm_url}) {
  bus_.subscribe(channel::kStatus, kMaxMessageBytes,
                 [this](auto bytes) { status_ = decoded<status_t>(bytes); });
  bus_.subscribe(channel::kPlanResponse, kMaxMessageBytes, [this](auto bytes) {
    auto response = decoded<plan_response_t>(bytes);
    if (response.request_id == request_id_) answer_ = std::move(response);
  });
}

status_t Remote::status() {
  waitForServer();
  return *status_;
}

void Remote::waitForServer() {
  for (const auto start = Clock::now(); !status_; bus_.wait(kTick_ms)) {
    if (secondsSince(start) > kStatusPatience_s) failNotReachable(lcm_url_);
  }
}

void Remote::checkSize(std::size_t bytes) const {
  const std::int64_t granted = status_->receive_buffer_granted;
  if (granted >= 0 && static_cast<std::int64_t>(bytes) > granted)
    throw InputError(fmt::format(
        "the cloud takes {} bytes, but the server's receive buffer holds {}, and LCM loses messages that do "
        "not fit; plan without the server (--local), thin the cloud to {} points, raise the buffer on the "
        "server's machine (sysctl -w net.core.rmem_max={}, then restart it), or use a tcpq:// broker",
        bytes, granted, granted / 12, bytes));
}

void Remote::send() {
  bus_.publish(channel::kPlanRequest, LcmBus::Bytes(request_));
  next_send_ = Clock::now() + pause_;
  pause_ = std::min(2 * pause_, kLongestPause);
}

bool Remote::serverHasIt() const {
  return status_ &&
         std::find(status_->active.begin(), status_->active.end(), request_id_) != status_->active.end();
}

void Remote::resendIfLost() {
  if (answer_) {  // it says 'overloaded'
    fmt::print(stderr, "boxgrasp: {}; asking again\n", answer_->message);
    answer_.reset();
    next_send_ = Clock::now() + pause_;
  }
  if (Clock::now() < next_send_ || serverHasIt()) return;
  fmt::print(stderr, "boxgrasp: no answer yet; asking again\n");
  send();
}

void Remote::cancel() {
  fmt::print(stderr, "boxgrasp: cancelling\n");
  bus_.publish(channel::kCancel, cancel_t{utimeNow(), request_id_});
}

void Remote::giveUpIfLate(double patience_s) const {
  const double waited_s = secondsSince(start_);
  if (!status_ && waited_s > kStatusPatience_s) failNotReachable(lcm_url_);
  if (status_ && waited_s > patience_s)
    throw NoAnswer(fmt::format(
        "no answer after {:.1f} s; give more time with --deadline-s, see 'boxgrasp status', or thin "
        "the cloud",
        waited_s));
}

plan_response_t Remote::plan(const RemotePlan& plan) {
  Interruption interruption;
  start_ = Clock::now();  // waiting for the first status counts, too
  request_id_ = plan.request_id.empty() ? newRequestId() : plan.request_id;
  request_ = encoded(toMessage(plan.request, {request_id_, plan.frame, plan.deadline_s, utimeNow()}));
  if (request_.size() > kSafeBytes) {
    waitForServer();
    checkSize(request_.size());
  }
  pause_ = kFirstPause;
  send();
  while (!answer_ || answer_->outcome == plan_response_t::OVERLOADED) {
    resendIfLost();
    if (interruption.take()) cancel();
    giveUpIfLate(plan.deadline_s > 0 ? plan.deadline_s + kGrace_s : kPatience_s);
    bus_.wait(kTick_ms);
  }
  return *answer_;
}

}  // namespace boxgrasp
