// What robots report of the daemon's grasps, kept on disk for the worker that learns from it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "boxgrasp/messaging/codec.h"
#include "boxgrasp/store/outcome_store.h"
#include "plan_service.h"

namespace boxgrasp {

// All calls from one thread at a time, none of them from where plans are made. A store that cannot be opened
// is tried again with each call.
class OutcomeDesk {
 public:
  // file: of the outcome store; empty: none, and nothing can be reported.
  OutcomeDesk(std::filesystem::path file, std::string hand);

  // Remembers an answer that has grasps, so that their outcomes can be reported. Throws InputError. Pre:
  // inputs of each of its grasps.
  void remember(const plan_response_t& answer, const AnswerInputs& inputs);
  // The reply says "stored" when the outcome is on disk. Never throws for what a robot sent.
  outcome_reply_t store(const grasp_outcome_t& outcome);

 private:
  OutcomeStore& opened();

  std::filesystem::path file_;
  std::string hand_;
  std::optional<OutcomeStore> store_;
};

}  // namespace boxgrasp
