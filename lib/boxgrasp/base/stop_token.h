// Deadline and cancellation, handed down to every long loop of the planner.
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>

namespace boxgrasp {

enum class StopReason { deadline, cancelled };

// Thrown by StopToken::check() and caught by the planner alone, which answers with what it has.
struct Stopped : std::exception {
  explicit Stopped(StopReason why) : reason(why) {}
  const char* what() const noexcept override {
    return reason == StopReason::deadline ? "deadline passed" : "cancelled";
  }
  StopReason reason;
};

// A cheap, copyable token. Default: never stops. An already expired deadline is legal.
class StopToken {
 public:
  using Clock = std::chrono::steady_clock;

  StopToken() = default;
  explicit StopToken(std::optional<Clock::time_point> deadline,
                     std::shared_ptr<const std::atomic<bool>> cancelled = nullptr)
      : deadline_(deadline), cancelled_(std::move(cancelled)) {}

  std::optional<StopReason> stopped() const {
    if (cancelled_ && cancelled_->load(std::memory_order_relaxed)) return StopReason::cancelled;
    if (deadline_ && Clock::now() >= *deadline_) return StopReason::deadline;
    return std::nullopt;
  }
  void check() const {
    if (const auto reason = stopped()) throw Stopped(*reason);
  }
  const std::optional<Clock::time_point>& deadline() const { return deadline_; }

 private:
  std::optional<Clock::time_point> deadline_;
  std::shared_ptr<const std::atomic<bool>> cancelled_;
};

}  // namespace boxgrasp
