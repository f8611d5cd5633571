#include "clerk.h"

#include <utility>

#include "boxgrasp/messaging/channels.h"
#include "boxgrasp/messaging/plan_conversion.h"

namespace boxgrasp {
namespace {

constexpr std::size_t kMostTasks = 1000;

}  // namespace

Clerk::Clerk(ModelDesk& models, OutcomeDesk& outcomes, std::function<void()> wake, Log log)
    : models_(models),
      outcomes_(outcomes),
      wake_(std::move(wake)),
      log_(std::move(log)),
      background_(kMostTasks, log_) {}

template <typename Message>
void Clerk::reply(const char* channel, const Message& message) {
  const std::lock_guard lock(mutex_);
  replies_.push_back({channel, encoded(message)});
  wake_();
}

void Clerk::publication(publish_model_t message) {
  if (publishing_.exchange(true)) return;
  const bool posted = background_.post([this, message = std::move(message)] {
    const model_reply_t answer = models_.publish(message);
    publishing_ = false;  // first: whoever has the reply may publish the next
    reply(channel::kModelReply, answer);
  });
  if (!posted) publishing_ = false;
}

void Clerk::request(models_request_t message) {
  background_.post(
      [this, message = std::move(message)] { reply(channel::kModelsReply, models_.answer(message)); });
}

void Clerk::outcome(grasp_outcome_t message) {
  outcome_reply_t busy{
      utimeNow(),    message.request_id,          message.grasp_index,
      message.robot, outcome_reply_t::NOT_STORED, "too many outcomes wait for the disk; report it again"};
  const bool posted = background_.post([this, message = std::move(message)] {
    const outcome_reply_t answer = outcomes_.store(message);
    if (answer.receipt == outcome_reply_t::NOT_STORED)
      log_("the outcome of request '" + answer.request_id + "' is not stored: " + answer.message);
    reply(channel::kOutcomeReply, answer);
  });
  if (!posted) reply(channel::kOutcomeReply, busy);
}

void Clerk::answered(plan_response_t answer, AnswerInputs inputs) {
  const std::string id = answer.request_id;
  const bool posted = background_.post([this, answer = std::move(answer), inputs = std::move(inputs)] {
    models_.observe(answer);
    outcomes_.remember(answer, inputs);
  });
  if (!posted) log_("the disk is behind: outcomes of request '" + id + "' cannot be reported");
}

void Clerk::listModels(std::function<void(models_reply_t)> take) {
  background_.post([this, take = std::move(take)] {
    models_request_t request{};
    request.action = models_request_t::LIST;
    take(models_.answer(request));
  });
}

std::vector<Reply> Clerk::takeReplies() {
  const std::lock_guard lock(mutex_);
  return std::exchange(replies_, {});
}

bool Clerk::idle() const {
  const bool done = background_.idle();
  const std::lock_guard lock(mutex_);
  return done && replies_.empty();
}

}  // namespace boxgrasp
