// What the daemon can be told besides the planner's options: section [server] of the configuration.
#pragma once

#include <cstdint>
#include <string>

#include "boxgrasp/planning/config_file.h"

namespace boxgrasp {

// deploy/boxgrasp.toml says what each is for and when to change it.
struct ServerOptions {
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  int workers = 2;
  int queue = 16;
  std::uint64_t queue_bytes = 512u << 20;
  double deadline_s = 30.0;
  std::string cloud_channel;
  std::uint64_t receive_buffer_bytes = 64u << 20;
  std::uint64_t answers = 256;
  std::uint64_t answers_bytes = 64u << 20;
  double stop_s = 20.0;
  std::string state_dir;
  std::string trusted_keys;
  std::string oldest_model;
  std::string http, metrics;
  std::uint64_t shown_plans = 20;
  std::uint64_t shown_bytes = 256u << 20;
  void validate() const;
};

// The defaults, changed by what the file's section [server] says.
ServerOptions readServerOptions(ConfigFile& file);

}  // namespace boxgrasp
