// Answers as JSON. `--local` and the server's answers come this way alike.
#pragma once

#include <nlohmann/json.hpp>

#include "boxgrasp/plan_response_t.hpp"
#include "boxgrasp/status_t.hpp"

namespace boxgrasp {

// Numbers that are not finite become null. Keys stand in a fixed order.
using Json = nlohmann::ordered_json;
Json planJson(const plan_response_t& response);
Json statusJson(const status_t& status);

// The text of it; what is not UTF-8 is replaced.
std::string jsonText(const Json& json);

}  // namespace boxgrasp
