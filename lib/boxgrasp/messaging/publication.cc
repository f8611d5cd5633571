#include "boxgrasp/messaging/publication.h"

#include <algorithm>

#include "boxgrasp/base/durable_file.h"
#include "boxgrasp/messaging/channels.h"
#include "boxgrasp/messaging/plan_conversion.h"
#include "boxgrasp/ranking/model_file.h"

namespace boxgrasp {

signature_t toMessage(const Signature& signature) {
  signature_t message;
  std::copy(signature.key.begin(), signature.key.end(), message.key);
  std::copy(signature.bytes.begin(), signature.bytes.end(), message.bytes);
  return message;
}

Signature fromMessage(const signature_t& message) {
  Signature signature;
  std::copy(std::begin(message.key), std::end(message.key), signature.key.begin());
  std::copy(std::begin(message.bytes), std::end(message.bytes), signature.bytes.begin());
  return signature;
}

publish_model_t publication(std::string_view model, const SigningKey& key) {
  publish_model_t message{};
  message.utime = utimeNow();
  message.request_id = newRequestId();
  message.model.assign(model.begin(), model.end());
  message.model_size = static_cast<std::int32_t>(message.model.size());
  message.signature = toMessage(key.sign(purpose::kModel, message.model));
  return message;
}

model_reply_t publishModel(const AskOptions& options, const std::filesystem::path& model_file,
                           const SigningKey& key) {
  const std::string bytes = readWhole(model_file, kMaxModelBytes);
  parseModel(bytes, model_file.string());
  return ask<model_reply_t>(options, channel::kPublishModel, publication(bytes, key), channel::kModelReply);
}

std::vector<std::uint8_t> signedBytes(models_request_t order) {
  order.signature = {};
  return encoded(order);
}

models_reply_t askModels(const AskOptions& options, std::int8_t action, const std::string& version,
                         const SigningKey* key) {
  models_request_t request{};
  request.utime = utimeNow();
  request.request_id = newRequestId();
  request.action = action;
  request.version = version;
  if (key) request.signature = toMessage(key->sign(purpose::kModels, signedBytes(request)));
  return ask<models_reply_t>(options, channel::kModelsRequest, request, channel::kModelsReply);
}

}  // namespace boxgrasp
