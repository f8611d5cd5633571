// boxgrasp monitor: what is said on the bus.
#pragma once

#include <string>
#include <vector>

namespace boxgrasp {

struct MonitorCommand {
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::vector<std::string> channels{"BOXGRASP_*"};  // '*' stands for any text
  double seconds = 0.0;                             // end after so long; 0: when interrupted
  bool once = false;                                // listen for `seconds`, then print one table
  bool json = false;
};

// On a terminal a table that is drawn anew each second, else a line for each message; with --json an object a
// line, each second. Counts what the multicast loses by the senders' own numbers. Returns 1 if nothing was
// heard. Throws what opening the bus throws.
int runMonitor(const MonitorCommand& command);

}  // namespace boxgrasp
