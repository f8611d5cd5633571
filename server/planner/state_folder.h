// Where the daemon keeps what outlives it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "boxgrasp/store/file_lock.h"

namespace boxgrasp {

// One daemon's folder, held from construction to destruction.
class StateFolder {
 public:
  // Makes the folder where there is none; an empty path is none. Throws InputError where it cannot be made,
  // or another server holds it.
  explicit StateFolder(const std::filesystem::path& folder);

  // A file in it; empty where there is no folder.
  std::filesystem::path file(const std::string& name) const;

 private:
  std::filesystem::path folder_;
  std::optional<FileLock> lock_;
};

}  // namespace boxgrasp
