// What a browser and a metrics collector get from a server: its latest plans, and how it is.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>

#include "boxgrasp/hand/hand_description.h"
#include "boxgrasp/live/plan_history.h"
#include "boxgrasp/live/server_state.h"
#include "boxgrasp/models_reply_t.hpp"
#include "boxgrasp/training_status_t.hpp"

namespace boxgrasp {

struct WebReply {
  int status = 200;  // of HTTP
  std::string type;
  std::string body;
  std::string policy = "default-src 'none'";  // Content-Security-Policy
};

struct LiveViewOptions {
  std::uint64_t max_plans = 20;
  std::uint64_t max_bytes = 256u << 20;
};

// Told by the server what happens, asked by those who look. Thread-safe.
class LiveView {
 public:
  using Clock = std::chrono::steady_clock;

  LiveView(HandDescription hand, const LiveViewOptions& options);

  void answered(const plan_response_t& answer, MadePlanPtr plan);
  void update(ServerState state);
  void update(const training_status_t& training);
  void update(models_reply_t models);
  // Somebody asked for a page's data within the last seconds.
  bool isLookedAt() const;

  // The page and its data; 404 for other paths:
  //   /                 the interactive page
  //   /api/status       {"schema": 1, ...}: as `boxgrasp status --json`, with the worker's training and all
  //   models /api/plans        {"schema": 1, "plans": [...]}: the latest requests, newest first
  //   /api/plans/<id>   the scene of one of them (viewer/plan_page.h)
  WebReply page(const std::string& path);
  // Only /metrics.
  WebReply metrics(const std::string& path) const;

 private:
  std::optional<training_status_t> trainingNow() const;
  WebReply statusPage();
  WebReply plansPage();
  WebReply planPage(const std::string& id);
  WebReply sceneOf(const AnsweredRequest& request);

  const HandDescription hand_;
  PlanHistory history_;
  mutable std::mutex mutex_;
  ServerState state_;
  std::optional<training_status_t> training_;
  Clock::time_point training_heard_;
  models_reply_t models_{};
  std::atomic<Clock::rep> looked_at_;

  // The scene that was asked for last: most who look look at the same one. One at a time is made.
  std::mutex scene_mutex_;
  std::int64_t scene_id_ = 0;
  std::string scene_;
};

}  // namespace boxgrasp
