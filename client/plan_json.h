// Answers as JSON. `--local` and the server's answers come this way alike.
#pragma once

#include <nlohmann/json.hpp>

#include "boxgrasp/live/status_json.h"
#include "boxgrasp/plan_response_t.hpp"

namespace boxgrasp {

// Numbers that are not finite become null. Keys stand in a fixed order.
using Json = nlohmann::ordered_json;
Json planJson(const plan_response_t& response);

// The text of it; what is not UTF-8 is replaced.
std::string jsonText(const Json& json);

}  // namespace boxgrasp
