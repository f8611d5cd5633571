// boxgrasp models: which models the server has, and which one it uses.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace boxgrasp {

struct ModelsCommand {
  std::string version, other;                // as the command needs them
  std::optional<std::filesystem::path> key;  // secret key file: orders are signed
};

// All print what came out, and return an exit code: 3 for an order that was refused. They throw what asking
// the server throws, and InputError for a version that the server does not have.
int runModelsList(const std::string& lcm_url, bool json);
int runModelsShow(const ModelsCommand& command, const std::string& lcm_url, bool json);
int runModelsCompare(const ModelsCommand& command, const std::string& lcm_url, bool json);
// action: PIN, UNPIN or ROLL_BACK of models_request_t.
int runModelsOrder(const ModelsCommand& command, int action, const std::string& lcm_url, bool json);

}  // namespace boxgrasp
