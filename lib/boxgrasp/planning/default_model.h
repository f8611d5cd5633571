// The model that is built into the programs.
#pragma once

#include <filesystem>
#include <optional>

#include "boxgrasp/hand/hand_description.h"
#include "boxgrasp/ranking/model_file.h"

namespace boxgrasp {

// The texts of deploy/models/default.json and parallel_gripper.json; empty when the library was built without
// them.
extern const char* const kDefaultModelJson;
extern const char* const kGripperModelJson;

// The file's model; without a file the one that is built in for such a hand: fingers that turn or jaws.
// Throws InputError for a bad file, or when neither is there.
Model modelOrDefault(const std::optional<std::filesystem::path>& file,
                     const HandDescription& hand = barrettHand());

}  // namespace boxgrasp
