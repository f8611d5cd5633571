#include "interruption.h"

#include <csignal>

namespace boxgrasp {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void interrupt(int signal) {
  interrupted = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

Interruption::Interruption()
    : before_int_(std::signal(SIGINT, interrupt)), before_term_(std::signal(SIGTERM, interrupt)) {
  interrupted = 0;
}

Interruption::~Interruption() {
  std::signal(SIGINT, before_int_);
  std::signal(SIGTERM, before_term_);
}

bool Interruption::asked() const { return interrupted != 0; }

bool Interruption::take() {
  const bool was = asked();
  interrupted = 0;
  return was;
}

}  // namespace boxgrasp
