// boxgrasp record and replay: the bus in a file, and out of it again.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace boxgrasp {

struct LogCommand {
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::filesystem::path file;                       // LCM's own format: lcm-logplayer and lcm-logger share it
  std::vector<std::string> channels{"BOXGRASP_*"};  // '*' stands for any text
  double seconds = 0.0;                             // record: end after so long; 0: when interrupted
  double speed = 1.0;                               // replay: times as fast as it was recorded
  bool json = false;
};

// Both print how much it was when they end, also by Ctrl-C. They throw InputError for files that cannot be
// written or read, and what opening the bus throws. A log without a message that fits: 1.
int runRecord(const LogCommand& command);
int runReplay(const LogCommand& command);

}  // namespace boxgrasp
