#include "progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace boxgrasp {

ProgressBar::ProgressBar(std::string what) : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() {
  if (terminal_) fmt::print(stderr, "\n");
}

void ProgressBar::update(std::size_t done, std::size_t total) {
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double left_s =
      done ? elapsed_s / static_cast<double>(done) * static_cast<double>(total - done) : 0.0;
  const std::string line =
      fmt::format("{}: {} of {}, {:.0f} s, about {:.0f} s left", what_, done, total, elapsed_s, left_s);
  if (terminal_) {
    fmt::print(stderr, "\r{}\033[K", line);
    std::fflush(stderr);
    return;
  }
  const std::size_t tenths = total ? 10 * done / total : 10;
  if (tenths > tenths_shown_) fmt::print(stderr, "{}\n", line);
  tenths_shown_ = tenths;
}

}  // namespace boxgrasp
