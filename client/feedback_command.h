// boxgrasp feedback: tells the server what became of a grasp.
#pragma once

#include <string>
#include <vector>

namespace boxgrasp {

struct FeedbackCommand {
  std::string request_id;
  int grasp_index = 0;
  bool succeeded = false;
  std::string what;
  std::string robot;  // empty: this machine's name
  std::vector<double> forces_n;
};

// Reports until the server says that it has the outcome on disk. Returns 0 then, 3 when the server refused
// it, 70 when the server cannot store it. Throws what asking the server throws.
int runFeedback(const FeedbackCommand& command, const std::string& lcm_url, bool json);

}  // namespace boxgrasp
