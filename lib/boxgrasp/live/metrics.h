// Prometheus' text format, version 0.0.4.
#pragma once

#include <optional>
#include <string>

#include "boxgrasp/live/server_state.h"
#include "boxgrasp/training_status_t.hpp"

namespace boxgrasp {

// Names begin with "boxgrasp_", units stand at their ends. A worker that is not heard has no metrics.
std::string metricsText(const ServerState& state, const std::optional<training_status_t>& training);

}  // namespace boxgrasp
