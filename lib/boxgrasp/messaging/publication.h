// Sending models, and orders about them, to the server.
#pragma once

#include <filesystem>

#include "boxgrasp/messaging/ask.h"
#include "boxgrasp/registry/signing.h"

namespace boxgrasp {

signature_t toMessage(const Signature& signature);
Signature fromMessage(const signature_t& message);

// The message that offers these bytes of a model file.
publish_model_t publication(std::string_view model, const SigningKey& key);

// Signs a model file, sends it, and waits for the server's answer, which says whether the model is in service
// or why it was refused. Throws InputError for a file that is no model, and what ask() throws.
model_reply_t publishModel(const AskOptions& options, const std::filesystem::path& model_file,
                           const SigningKey& key);

// The bytes of an order that are signed: of the message with a signature of zeros.
std::vector<std::uint8_t> signedBytes(models_request_t order);

// Sends the request, signed where a key is given. Orders need one; LIST does not. Throws what ask() throws.
models_reply_t askModels(const AskOptions& options, std::int8_t action, const std::string& version,
                         const SigningKey* key);

}  // namespace boxgrasp
