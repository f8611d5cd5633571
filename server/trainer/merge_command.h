// boxgrasp-trainer merge: one experience store of several.
#pragma once

#include <filesystem>
#include <vector>

namespace boxgrasp {

struct MergeCommand {
  std::filesystem::path out;
  std::vector<std::filesystem::path> shards;
  bool json = false;
};

// Adds to the store what it does not hold; merging again changes nothing. Throws InputError for stores of
// other settings, or with other content under the same name.
void runMerge(const MergeCommand& command);

}  // namespace boxgrasp
