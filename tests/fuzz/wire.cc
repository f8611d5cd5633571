// Messages from the bus, one type a program: MESSAGE. The fingerprint is put right first, so that mutations
// get past it.
#include <algorithm>

#include "boxgrasp/messaging/cloud_conversion.h"
#include "boxgrasp/messaging/codec.h"
#include "boxgrasp/messaging/plan_conversion.h"
#include "boxgrasp/messaging/publication.h"
#include "fuzz_target.h"
#include "plan_json.h"
#include "plan_text.h"
#include "random_messages.h"

namespace boxgrasp::fuzz {

constexpr std::size_t kFingerprint = 8;

// What the programs do with a message, as far as it looks at more of it. Each program uses one of these, so
// they are not in an unnamed namespace.
template <typename Message>
void use(const Message&) {}
void use(const plan_request_t& message) {
  accepts([&] { fromMessage(message); });
}
void use(const drake::lcmt_point_cloud& message) {
  accepts([&] { promise(fromMessage(message).size() <= message.data.size()); });
}
void use(const plan_response_t& message) {
  planText(message);
  explanationText(message);
  jsonText(planJson(message));
}
void use(const status_t& message) {
  statusText(message);
  jsonText(statusJson(message));
}
void use(const models_request_t& message) { signedBytes(message); }

template <typename Message>
Message example(std::mt19937_64&) {
  return {};
}
template <>
plan_request_t example(std::mt19937_64& random) {
  return test::randomRequest(random, 5);
}
template <>
plan_response_t example(std::mt19937_64& random) {
  return test::randomResponse(random);
}
template <>
drake::lcmt_point_cloud example(std::mt19937_64& random) {
  return test::randomRequest(random, 5).cloud;
}
template <>
publish_model_t example(std::mt19937_64&) {
  publish_model_t message{};
  message.request_id = "publication";
  message.model = {'{', '}'};
  message.model_size = 2;
  return message;
}
template <>
models_reply_t example(std::mt19937_64&) {
  models_reply_t message{};
  message.models.resize(2);
  message.num_models = 2;
  message.models[1].version = "0badc0de";
  message.models[1].metrics.push_back({"s_net", 0.5});
  message.models[1].num_metrics = 1;
  return message;
}
template <>
grasp_outcome_t example(std::mt19937_64&) {
  return {1, "plan", 3, "robot", 1, "held", 2, {1.5, 2.5}};
}
template <>
status_t example(std::mt19937_64&) {
  status_t message{};
  message.active = {"one", "two"};
  message.num_active = 2;
  return message;
}

void feed(Bytes bytes) {
  static const std::vector<std::uint8_t> fingerprint = encoded(MESSAGE{});
  std::vector<std::uint8_t> message(bytes.begin(), bytes.end());
  std::copy_n(fingerprint.begin(), std::min(kFingerprint, message.size()), message.begin());
  accepts([&] {
    const auto decoded_message = decoded<MESSAGE>(message);
    use(decoded_message);
    // Strings end at their first zero for LCM's encoder, so the bytes may be fewer, but not another message.
    const auto again = encoded(decoded_message);
    promise(again.size() <= message.size() && encoded(decoded<MESSAGE>(again)) == again);
  });
}

std::vector<std::string> seeds() {
  std::mt19937_64 random(1);
  return {textOf(encoded(MESSAGE{})), textOf(encoded(example<MESSAGE>(random)))};
}

}  // namespace boxgrasp::fuzz
