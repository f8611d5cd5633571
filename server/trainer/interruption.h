// Ctrl-C as a request to stop, instead of the end of the program.
#pragma once

#include "boxgrasp/base/stop_token.h"

namespace boxgrasp {

// From now on the first SIGINT or SIGTERM stops whoever holds such a token; a second one ends the program.
StopToken stopOnInterrupt();

}  // namespace boxgrasp
