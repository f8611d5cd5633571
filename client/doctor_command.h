// boxgrasp doctor: what is wrong between this machine and a server, and how to mend it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace boxgrasp {

struct DoctorCommand {
  std::filesystem::path state_dir = "/var/lib/boxgrasp",
                        trusted_keys = "/etc/boxgrasp/keys";  // the service's
  std::optional<std::filesystem::path> model;
};

// Checks multicast, receive buffer, server, clock, model, keys and store; prints a line for each. Exit code:
// done, or nothing found when a check failed; warnings are no failure.
int runDoctor(const DoctorCommand& command, const std::string& lcm_url, bool json);

}  // namespace boxgrasp
