// Answers as tables for people.
#pragma once

#include <string>

#include "boxgrasp/plan_response_t.hpp"
#include "boxgrasp/status_t.hpp"

namespace boxgrasp {

// The ranked grasps, or why there are none.
std::string planText(const plan_response_t& response);

// How many candidates each stage took and gave, why they fell, and what to turn.
std::string explanationText(const plan_response_t& response);

std::string statusText(const status_t& status);

}  // namespace boxgrasp
