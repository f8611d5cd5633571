// The plans that a server made lately, for those who look.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "boxgrasp/plan_response_t.hpp"
#include "boxgrasp/planning/plan.h"

namespace boxgrasp {

// A plan as the planner left it: what a page shows of it is made when somebody looks.
struct MadePlan {
  PlanResult result;
  PlanTrace trace;
  // Of its clouds, trees, images and grasps.
  std::size_t bytes() const;
};
using MadePlanPtr = std::shared_ptr<const MadePlan>;

struct AnsweredRequest {
  std::int64_t id = 0;  // counts the requests from 1
  std::string request_id;
  std::int64_t utime = 0;    // when the answer was ready, microseconds since 1970
  std::int8_t outcome = -1;  // of plan_response_t
  std::string message;
  std::string model_version;
  std::int64_t num_grasps = 0;
  double time_s = 0.0;
  MadePlanPtr plan;  // null for a request that was not planned: refused, overloaded, too late
};

// Bounded by count and bytes, the oldest go first; requests that were not planned have half of the places at
// most, so that a flood of refused ones leaves the plans. Thread-safe.
class PlanHistory {
 public:
  PlanHistory(std::uint64_t max_count, std::uint64_t max_bytes)
      : max_count_(max_count), max_bytes_(max_bytes) {}

  void add(const plan_response_t& answer, MadePlanPtr plan);
  std::vector<AnsweredRequest> newestFirst() const;
  std::optional<AnsweredRequest> find(std::int64_t id) const;

 private:
  struct Entry {
    AnsweredRequest request;
    std::size_t bytes = 0;
  };
  std::list<Entry> takeSurplus();
  std::list<Entry>::iterator nextToGo();

  const std::uint64_t max_count_, max_bytes_;
  mutable std::mutex mutex_;
  std::list<Entry> entries_;  // newest first
  std::int64_t last_id_ = 0;
};

}  // namespace boxgrasp
