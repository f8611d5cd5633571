// The daemon's one thread for everything outside: LCM, signals, systemd.
#pragma once

#include "plan_service.h"

namespace boxgrasp {

// Serves until SIGTERM or SIGINT: then what runs is finished, within options.stop_s, and what waits is
// answered. A second signal cancels what runs. Logs to the default logger. Throws InputError when the bus
// cannot be opened or another server is on it, TransportError when it dies.
void serve(GraspPlanner planner, const ServerOptions& options);

}  // namespace boxgrasp
