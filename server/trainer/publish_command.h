// boxgrasp-trainer publish: a model file, signed, to the running server.
#pragma once

#include <filesystem>

#include "boxgrasp/messaging/ask.h"

namespace boxgrasp {

struct PublishCommand {
  std::filesystem::path model, key;
  AskOptions server;
  bool json = false;
};

// Prints the server's answer, and returns the exit code that goes with it: 0 when the server has the model on
// disk, 3 when it refused it, 70 when it failed. Throws what publishModel() throws.
int runPublish(const PublishCommand& command);

}  // namespace boxgrasp
