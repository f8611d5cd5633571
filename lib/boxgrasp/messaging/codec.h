// Messages to bytes and back.
#pragma once

#include <span>
#include <vector>

#include "boxgrasp/cancel_t.hpp"
#include "boxgrasp/grasp_outcome_t.hpp"
#include "boxgrasp/messaging/wire_check.h"
#include "boxgrasp/model_reply_t.hpp"
#include "boxgrasp/models_reply_t.hpp"
#include "boxgrasp/models_request_t.hpp"
#include "boxgrasp/outcome_reply_t.hpp"
#include "boxgrasp/plan_request_t.hpp"
#include "boxgrasp/plan_response_t.hpp"
#include "boxgrasp/publish_model_t.hpp"
#include "boxgrasp/retrain_request_t.hpp"
#include "boxgrasp/status_t.hpp"
#include "boxgrasp/training_status_t.hpp"
#include "drake/lcmt_point_cloud.hpp"

namespace boxgrasp {

// The layout of a message type.
template <typename Message>
const WireLayout& layoutOf();
template <>
inline const WireLayout& layoutOf<drake::lcmt_point_cloud>() {
  return wire::kPointCloud;
}
template <>
inline const WireLayout& layoutOf<plan_request_t>() {
  return wire::kPlanRequest;
}
template <>
inline const WireLayout& layoutOf<plan_response_t>() {
  return wire::kPlanResponse;
}
template <>
inline const WireLayout& layoutOf<status_t>() {
  return wire::kStatus;
}
template <>
inline const WireLayout& layoutOf<cancel_t>() {
  return wire::kCancel;
}
template <>
inline const WireLayout& layoutOf<publish_model_t>() {
  return wire::kPublishModel;
}
template <>
inline const WireLayout& layoutOf<model_reply_t>() {
  return wire::kModelReply;
}
template <>
inline const WireLayout& layoutOf<models_request_t>() {
  return wire::kModelsRequest;
}
template <>
inline const WireLayout& layoutOf<models_reply_t>() {
  return wire::kModelsReply;
}
template <>
inline const WireLayout& layoutOf<grasp_outcome_t>() {
  return wire::kGraspOutcome;
}
template <>
inline const WireLayout& layoutOf<outcome_reply_t>() {
  return wire::kOutcomeReply;
}
template <>
inline const WireLayout& layoutOf<retrain_request_t>() {
  return wire::kRetrainRequest;
}
template <>
inline const WireLayout& layoutOf<training_status_t>() {
  return wire::kTrainingStatus;
}

template <typename Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(message.getEncodedSize());
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

// Checks the bytes first; throws InputError for any that are not a message of this type.
template <typename Message>
Message decoded(std::span<const std::uint8_t> bytes) {
  checkWire(bytes, layoutOf<Message>());
  Message message;
  message.decode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return message;
}

}  // namespace boxgrasp
