// The channels on which the service talks.
#pragma once

namespace boxgrasp::channel {

inline constexpr char kPlanRequest[] = "BOXGRASP_PLAN_REQUEST";        // boxgrasp::plan_request_t
inline constexpr char kPlanResponse[] = "BOXGRASP_PLAN_RESPONSE";      // boxgrasp::plan_response_t
inline constexpr char kStatus[] = "BOXGRASP_STATUS";                   // boxgrasp::status_t, 1 Hz
inline constexpr char kCancel[] = "BOXGRASP_CANCEL";                   // boxgrasp::cancel_t
inline constexpr char kPublishModel[] = "BOXGRASP_PUBLISH_MODEL";      // boxgrasp::publish_model_t
inline constexpr char kModelReply[] = "BOXGRASP_MODEL_REPLY";          // boxgrasp::model_reply_t
inline constexpr char kModelsRequest[] = "BOXGRASP_MODELS_REQUEST";    // boxgrasp::models_request_t
inline constexpr char kModelsReply[] = "BOXGRASP_MODELS_REPLY";        // boxgrasp::models_reply_t
inline constexpr char kGraspOutcome[] = "BOXGRASP_GRASP_OUTCOME";      // boxgrasp::grasp_outcome_t
inline constexpr char kOutcomeReply[] = "BOXGRASP_OUTCOME_REPLY";      // boxgrasp::outcome_reply_t
inline constexpr char kRetrainRequest[] = "BOXGRASP_RETRAIN_REQUEST";  // boxgrasp::retrain_request_t
inline constexpr char kTrainingStatus[] = "BOXGRASP_TRAINING_STATUS";  // boxgrasp::training_status_t, 1 Hz

}  // namespace boxgrasp::channel
