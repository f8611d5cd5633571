// The channels on which the service talks.
#pragma once

namespace boxgrasp::channel {

inline constexpr char kPlanRequest[] = "BOXGRASP_PLAN_REQUEST";    // boxgrasp::plan_request_t
inline constexpr char kPlanResponse[] = "BOXGRASP_PLAN_RESPONSE";  // boxgrasp::plan_response_t
inline constexpr char kStatus[] = "BOXGRASP_STATUS";               // boxgrasp::status_t, 1 Hz
inline constexpr char kCancel[] = "BOXGRASP_CANCEL";               // boxgrasp::cancel_t

}  // namespace boxgrasp::channel
