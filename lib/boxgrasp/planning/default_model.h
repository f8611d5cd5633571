// The model that is built into the programs.
#pragma once

#include <filesystem>
#include <optional>

#include "boxgrasp/ranking/model_file.h"

namespace boxgrasp {

// The text of deploy/models/default.json; empty when the library was built without that file.
extern const char* const kDefaultModelJson;

// The file's model; without a file the built-in one. Throws InputError for a bad file, or when neither is
// there.
Model modelOrDefault(const std::optional<std::filesystem::path>& file);

}  // namespace boxgrasp
