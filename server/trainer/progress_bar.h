// Progress on a terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace boxgrasp {

// One line on stderr that counts up, with the time that is left at the present rate. On a terminal the line
// is rewritten; in a file or pipe only every tenth of the work makes a line.
class ProgressBar {
 public:
  explicit ProgressBar(std::string what);
  ~ProgressBar();
  void update(std::size_t done, std::size_t total);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

 private:
  std::string what_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  bool terminal_;
  std::size_t tenths_shown_ = 0;
};

}  // namespace boxgrasp
