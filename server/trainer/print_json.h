// What the commands print with --json.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace boxgrasp {

// Names of files and texts of servers may hold bytes that are not UTF-8: they are replaced.
template <typename Json>
void printJson(const Json& json) {
  fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
}

}  // namespace boxgrasp
