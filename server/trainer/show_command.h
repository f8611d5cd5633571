// boxgrasp-trainer show: one grasp as a filmstrip.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace boxgrasp {

struct ShowCommand {
  std::string grasp;                           // "mug@1.00/whole/planner/17"
  std::optional<std::filesystem::path> store;  // with its label; without: planned anew with the defaults
  std::string objects = "builtin";             // where the object's mesh is: or a folder of meshes
  std::filesystem::path out = "grasp.png";
  int perturbation = 0;  // which of the store's labels
};

// Tries the grasp once more, from the approach to the push, draws what happens, and says where that differs
// from the store's label. Throws InputError.
void runShow(const ShowCommand& command);

}  // namespace boxgrasp
