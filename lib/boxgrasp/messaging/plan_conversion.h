// Requests and plans as messages and back.
#pragma once

#include <string>

#include "boxgrasp/plan_request_t.hpp"
#include "boxgrasp/plan_response_t.hpp"
#include "boxgrasp/planning/plan.h"

namespace boxgrasp {

// What a request carries besides the planner's part.
struct RequestEnvelope {
  std::string request_id;
  std::string frame;        // name of the cloud's frame
  double deadline_s = 0.0;  // from arrival; 0: the server's default
  std::int64_t utime = 0;
};

plan_request_t toMessage(const PlanRequest& request, const RequestEnvelope& envelope);

// The planner's part of a request, with PlanRequest's defaults where it asks for the default. Throws
// InputError naming the member for numbers that cannot be.
PlanRequest fromMessage(const plan_request_t& message);

// The answer; its utime is the sender's to set. The boxes of all objects stand one after the other, and a
// grasp's box counts through all of them.
plan_response_t toMessage(const PlanResult& result, const std::string& request_id, const std::string& frame);

// An answer without a plan: refused, overloaded, failed.
plan_response_t refusal(std::int8_t outcome, const std::string& message, const std::string& request_id,
                        const std::string& frame);

// "grasps", "no_grasp", ..., "overloaded", "internal_error"; "unknown" for what is none of the constants.
std::string_view outcomeName(std::int8_t outcome);

// Now, in microseconds since 1970.
std::int64_t utimeNow();

}  // namespace boxgrasp
