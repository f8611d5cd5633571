#include "feedback_command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>

#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/messaging/ask.h"
#include "boxgrasp/messaging/channels.h"
#include "boxgrasp/messaging/plan_conversion.h"
#include "plan_json.h"

namespace boxgrasp {
namespace {

struct Conclusion {
  const char* name;
  ExitCode code;
};

// By outcome_reply_t.receipt.
constexpr std::array kConclusions{Conclusion{"stored", kDone},
                                  Conclusion{"duplicate", kDone},
                                  Conclusion{"unknown_request", kBadInput},
                                  Conclusion{"unknown_grasp", kBadInput},
                                  Conclusion{"conflicting", kBadInput},
                                  Conclusion{"bad_input", kBadInput},
                                  Conclusion{"not_stored", kInternalError}};

std::string hostName() {
  char host[65] = {};
  gethostname(host, sizeof host - 1);
  return host;
}

grasp_outcome_t messageOf(const FeedbackCommand& command) {
  grasp_outcome_t message{};
  message.utime = utimeNow();
  message.request_id = command.request_id;
  message.grasp_index = command.grasp_index;
  message.robot = command.robot.empty() ? hostName() : command.robot;
  message.succeeded = command.succeeded;
  message.what = command.what;
  message.forces_n = command.forces_n;
  message.num_forces = static_cast<std::int32_t>(command.forces_n.size());
  return message;
}

outcome_reply_t replyTo(const grasp_outcome_t& message, const std::string& lcm_url) {
  outcome_reply_t reply;
  ask({.lcm_url = lcm_url}, channel::kGraspOutcome, encoded(message), channel::kOutcomeReply,
      [&](LcmBus::Bytes bytes) {
        reply = decoded<outcome_reply_t>(bytes);
        return reply.request_id == message.request_id && reply.grasp_index == message.grasp_index &&
               reply.robot == message.robot;
      });
  return reply;
}

}  // namespace

int runFeedback(const FeedbackCommand& command, const std::string& lcm_url, bool json) {
  const outcome_reply_t reply = replyTo(messageOf(command), lcm_url);
  const bool known = reply.receipt >= 0 && reply.receipt < static_cast<int>(kConclusions.size());
  const Conclusion& conclusion = kConclusions[known ? reply.receipt : outcome_reply_t::NOT_STORED];
  if (json)
    fmt::print("{}\n", jsonText({{"schema", 1}, {"receipt", conclusion.name}, {"message", reply.message}}));
  if (conclusion.code != kDone)
    fmt::print(stderr, "boxgrasp: {}\n", reply.message);
  else if (!json)
    fmt::print("{}\n", reply.message);
  return conclusion.code;
}

}  // namespace boxgrasp
