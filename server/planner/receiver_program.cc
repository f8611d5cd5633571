#include "receiver_program.h"

#include <fmt/format.h>
#include <unistd.h>

#include "boxgrasp/base/error.h"

namespace boxgrasp {

namespace fs = std::filesystem;

fs::path receiverProgram(const fs::path& folder) {
  constexpr const char* kName = "boxgrasp-receiver";
  const fs::path beside = folder / kName;
  const fs::path installed = folder.parent_path() / "libexec/boxgrasp" / kName;
  for (const fs::path& program : {beside, installed}) {
    if (access(program.c_str(), X_OK) == 0) return program;
  }
  throw InputError(
      fmt::format("the program that receives for the server is missing: neither {} nor {} can be executed; "
                  "install it there",
                  beside.string(), installed.string()));
}

fs::path ownFolder() { return fs::read_symlink("/proc/self/exe").parent_path(); }

}  // namespace boxgrasp
