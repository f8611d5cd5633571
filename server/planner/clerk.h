// What the daemon does beside planning: models, and outcomes.
#pragma once

#include <atomic>
#include <vector>

#include "background.h"
#include "model_desk.h"
#include "outcome_desk.h"

namespace boxgrasp {

struct Reply {
  std::string channel;
  std::vector<std::uint8_t> bytes;  // an encoded message
};

// Takes what arrives on the bus, has it dealt with by the desks in the background, and collects their
// replies. All calls from the thread of the bus.
class Clerk {
 public:
  using Log = std::function<void(const std::string&)>;

  // The desks are the clerk's alone as long as it lives. `wake` is called from the background when replies
  // wait; `log` from there too.
  Clerk(ModelDesk& models, OutcomeDesk& outcomes, std::function<void()> wake, Log log);

  // One at a time: the others are ignored, and their publishers send them again.
  void publication(publish_model_t message);
  void request(models_request_t message);
  void outcome(grasp_outcome_t message);
  // An answer that was planned just now: it is remembered for outcomes, and counts in the trial of a new
  // model. To be called before the answer is sent, so that no outcome can be dealt with earlier.
  void answered(plan_response_t answer, AnswerInputs inputs);

  // Hands the list of all models to `take`, from the background.
  void listModels(std::function<void(models_reply_t)> take);

  std::vector<Reply> takeReplies();
  // Nothing waits, runs, or is to be taken.
  bool idle() const;

 private:
  template <typename Message>
  void reply(const char* channel, const Message& message);

  ModelDesk& models_;
  OutcomeDesk& outcomes_;
  const std::function<void()> wake_;
  const Log log_;
  std::atomic<bool> publishing_ = false;
  mutable std::mutex mutex_;
  std::vector<Reply> replies_;
  Background background_;  // last: its tasks use the others
};

}  // namespace boxgrasp
