// boxgrasp-trainer keygen: a key pair for publishing models.
#pragma once

#include <filesystem>

namespace boxgrasp {

struct KeygenCommand {
  std::filesystem::path out = "boxgrasp.key";  // the secret half; the public one goes into "<out>.pub"
  bool json = false;
};

// Writes both and prints what to do with them. Throws InputError where one exists already.
void runKeygen(const KeygenCommand& command);

}  // namespace boxgrasp
