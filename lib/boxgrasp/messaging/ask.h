// One question to the server, and its answer.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

#include "boxgrasp/messaging/lcm_bus.h"

namespace boxgrasp {

// Nobody answers on the bus.
class NotReachable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// There is a server, but its answer did not come in time.
class NoAnswer : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct AskOptions {
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  double timeout_s = 30.0;  // for the answer of a server that is there
};

// Unique among all senders: host, process, time.
std::string newRequestId();

// Sends the bytes, again after a while, until `take` says that a message on the answer's channel is the
// answer. Only for questions that the server answers alike when they come twice. Throws NotReachable when no
// server is heard within 5 s, NoAnswer after the timeout, InputError for a message that the server's receive
// buffer cannot take, TransportError.
void ask(const AskOptions& options, const std::string& channel, LcmBus::Bytes question,
         const std::string& answer_channel, const std::function<bool(LcmBus::Bytes)>& take);

// The same for messages with a request_id.
template <typename Answer, typename Question>
Answer ask(const AskOptions& options, const std::string& channel, const Question& question,
           const std::string& answer_channel) {
  Answer answer;
  ask(options, channel, encoded(question), answer_channel, [&](LcmBus::Bytes bytes) {
    answer = decoded<Answer>(bytes);
    return answer.request_id == question.request_id;
  });
  return answer;
}

}  // namespace boxgrasp
