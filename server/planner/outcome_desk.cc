#include "outcome_desk.h"

#include <fmt/format.h>

#include "boxgrasp/messaging/plan_conversion.h"

namespace boxgrasp {
namespace {

RememberedAnswer remembered(const plan_response_t& answer, const AnswerInputs& inputs,
                            const std::string& hand) {
  RememberedAnswer result{
      answer.request_id,
      answer.utime,
      {answer.model_version, fmt::format("{}", fmt::join(inputs.features, " ")), hand, ""},
      {}};
  for (std::size_t i = 0; i < answer.grasps.size(); ++i)
    result.grasps.push_back({inputs.grasps.at(i), answer.grasps[i].score});
  return result;
}

RobotOutcome reported(const grasp_outcome_t& message) {
  RobotOutcome outcome;
  outcome.request_id = message.request_id;
  outcome.grasp_index = message.grasp_index;
  outcome.robot = message.robot;
  outcome.succeeded = message.succeeded != 0;
  outcome.what = message.what;
  outcome.forces_n = message.forces_n;
  outcome.utime = message.utime;
  return outcome;
}

// The constants of outcome_reply_t stand in the order of OutcomeReceipt.
static_assert(static_cast<int>(OutcomeReceipt::duplicate) == outcome_reply_t::DUPLICATE &&
              static_cast<int>(OutcomeReceipt::unknown_request) == outcome_reply_t::UNKNOWN_REQUEST &&
              static_cast<int>(OutcomeReceipt::unknown_grasp) == outcome_reply_t::UNKNOWN_GRASP &&
              static_cast<int>(OutcomeReceipt::conflicting) == outcome_reply_t::CONFLICTING);

std::string messageOf(OutcomeReceipt receipt, const grasp_outcome_t& outcome) {
  switch (receipt) {
    case OutcomeReceipt::stored:
      return fmt::format("the outcome of grasp {} of request '{}' is stored", outcome.grasp_index,
                         outcome.request_id);
    case OutcomeReceipt::duplicate:
      return fmt::format("robot '{}' has reported this before; it counts once", outcome.robot);
    case OutcomeReceipt::unknown_request:
      return fmt::format(
          "this server has given no answer with grasps to a request '{}', or has forgotten it; report with "
          "the "
          "request's id as it was planned",
          outcome.request_id);
    case OutcomeReceipt::unknown_grasp:
      return fmt::format("the answer to request '{}' has no grasp {}; the first grasp has index 0",
                         outcome.request_id, outcome.grasp_index);
    case OutcomeReceipt::conflicting:
      return fmt::format("robot '{}' has reported the opposite before, and that stays", outcome.robot);
  }
  return {};
}

}  // namespace

OutcomeDesk::OutcomeDesk(std::filesystem::path file, std::string hand)
    : file_(std::move(file)), hand_(std::move(hand)) {}

OutcomeStore& OutcomeDesk::opened() {
  if (file_.empty()) throw StoreError("this server keeps no outcomes: start it with --state-dir FOLDER");
  if (!store_) store_.emplace(file_);
  return *store_;
}

void OutcomeDesk::remember(const plan_response_t& answer, const AnswerInputs& inputs) {
  if (!file_.empty() && !answer.grasps.empty()) opened().rememberAnswer(remembered(answer, inputs, hand_));
}

outcome_reply_t OutcomeDesk::store(const grasp_outcome_t& outcome) {
  outcome_reply_t reply{utimeNow(),    outcome.request_id,          outcome.grasp_index,
                        outcome.robot, outcome_reply_t::NOT_STORED, ""};
  try {
    const OutcomeReceipt receipt = opened().addOutcome(reported(outcome));
    reply.receipt = static_cast<std::int8_t>(receipt);
    reply.message = messageOf(receipt, outcome);
  } catch (const StoreError& error) {
    reply.message = error.what();
  } catch (const InputError& error) {
    reply.receipt = outcome_reply_t::BAD_INPUT;
    reply.message = error.what();
  }
  return reply;
}

}  // namespace boxgrasp
