// One round of the worker: from labels and outcomes to a candidate, its comparison, and its publication.
#pragma once

#include <functional>

#include "boxgrasp/store/outcome_store.h"
#include "boxgrasp/training/gate.h"
#include "work_command.h"

namespace boxgrasp {

// How far a round is.
struct RoundProgress {
  std::int8_t state = 0;  // training_status_t
  std::string stage;      // in words
  double share = 0.0;     // 0 to 1
};

struct RoundResult {
  std::string candidate, in_service;  // versions
  std::int64_t labels = 0, outcomes = 0;
  bool published = false;
  std::string words;  // how it ended, with the comparison
};

// The labels, once read: they do not change while the worker runs.
struct SplitLabels {
  StudyData training;
  std::vector<GraspList> held_out;
};
SplitLabels splitLabels(const WorkCommand& command, const StopToken& stop);

// Trains on the labels and all outcomes but those kept out, writes candidate and comparison into
// `command.keep`, and publishes where the gate lets it and a key is given. `in_service` is the version that
// the server uses; empty: unknown, and the built-in model is taken for it. Throws Stopped, InputError, and
// what publishing throws.
RoundResult runRound(const WorkCommand& command, const SplitLabels& labels,
                     const std::vector<StoredOutcome>& outcomes, const std::string& in_service,
                     const std::function<void(const RoundProgress&)>& report, const StopToken& stop);

}  // namespace boxgrasp
