#include "publish_command.h"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "boxgrasp/base/exit_code.h"
#include "boxgrasp/messaging/publication.h"
#include "print_json.h"

namespace boxgrasp {
namespace {

struct Conclusion {
  const char* name;
  ExitCode code;
};

// By model_reply_t.outcome.
constexpr std::array kConclusions{Conclusion{"in_service", kDone}, Conclusion{"kept", kDone},
                                  Conclusion{"refused", kBadInput}, Conclusion{"failed", kInternalError}};

}  // namespace

int runPublish(const PublishCommand& command) {
  const model_reply_t reply = publishModel(command.server, command.model, SigningKey(command.key));
  const bool known = reply.outcome >= 0 && reply.outcome < static_cast<int>(kConclusions.size());
  const Conclusion& conclusion = kConclusions[known ? reply.outcome : model_reply_t::FAILED];
  if (command.json)
    printJson(nlohmann::ordered_json{
        {"schema", 1}, {"outcome", conclusion.name}, {"version", reply.version}, {"message", reply.message}});
  if (conclusion.code != kDone)
    fmt::print(stderr, "boxgrasp-trainer: {}: {}\n", conclusion.name, reply.message);
  else if (!command.json)
    fmt::print("accepted: {}\n", reply.message);
  return conclusion.code;
}

}  // namespace boxgrasp
