#include "interruption.h"

#include <csignal>

namespace boxgrasp {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "else a signal handler may not set it");

void interrupt(int signal) {
  interrupted = true;
  std::signal(signal, SIG_DFL);
}

}  // namespace

StopToken stopOnInterrupt() {
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  return StopToken(std::nullopt, {std::shared_ptr<void>(), &interrupted});
}

}  // namespace boxgrasp
