#include "state_folder.h"

#include <fmt/format.h>

#include "boxgrasp/base/error.h"

namespace boxgrasp {

StateFolder::StateFolder(const std::filesystem::path& folder) : folder_(folder) {
  if (folder_.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error)
    throw InputError(fmt::format("the state folder '{}' cannot be made: {}; name another with --state-dir",
                                 folder_.string(), error.message()));
  lock_.emplace(folder_ / "boxgrasp-server");
  if (!lock_->tryLock())
    throw InputError(fmt::format(
        "another boxgrasp-server uses the state folder '{}'; end it first, or name another with --state-dir",
        folder_.string()));
}

std::filesystem::path StateFolder::file(const std::string& name) const {
  return folder_.empty() ? folder_ : folder_ / name;
}

}  // namespace boxgrasp
