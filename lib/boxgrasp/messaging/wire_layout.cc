#include "boxgrasp/messaging/wire_layout.h"

#include <array>
#include <string>

#include "boxgrasp/geometry/viewpoints.h"

namespace boxgrasp {
namespace wire {
namespace {

constexpr std::int64_t kMaxCandidates = 1 << 20;  // grasps, boxes: far more than any plan has
constexpr std::int64_t kMaxRows = 4096;           // stages, reasons, notes, fields

constexpr WireField one(std::string_view name, WireType type) { return {.name = name, .type = type}; }
constexpr WireField one(std::string_view name, const WireLayout& record) {
  return {.name = name, .type = WireType::record, .record = &record};
}
constexpr WireField fixed(std::string_view name, WireType type, int n) {
  return {.name = name, .type = type, .fixed = n};
}
constexpr WireField many(std::string_view name, WireType type, std::string_view count, std::int64_t cap) {
  return {.name = name, .type = type, .count = count, .cap = cap};
}
constexpr WireField many(std::string_view name, const WireLayout& record, std::string_view count,
                         std::int64_t cap) {
  return {.name = name, .type = WireType::record, .record = &record, .count = count, .cap = cap};
}

using enum WireType;

constexpr WireField kPointCloudFieldFields[] = {
    one("name", text),
    one("byte_offset", int32),
    one("datatype", int8),
    one("count", int32),
};
constexpr WireLayout kPointCloudField{"lcmt_point_cloud_field", kPointCloudFieldFields};

constexpr WireField kPointCloudFields[] = {
    one("utime", int64),
    one("frame_name", text),
    one("width", int64),
    one("height", int64),
    one("num_fields", int32),
    many("fields", kPointCloudField, "num_fields", kMaxRows),
    one("flags", int64),
    one("point_step", int32),
    one("row_step", int64),
    one("filler_size", int16),
    many("filler", byte, "filler_size", kMaxMessageBytes),
    one("data_size", int64),
    many("data", byte, "data_size", kMaxMessageBytes),
};

constexpr WireField kContactFields[] = {fixed("position_m", float64, 3), fixed("normal", float64, 3),
                                        one("seen", boolean)};
constexpr WireLayout kContact{"contact_t", kContactFields};

constexpr WireField kGraspFields[] = {
    one("score", float64),
    fixed("palm_position_m", float64, 3),
    fixed("palm_quaternion_wxyz", float64, 4),
    fixed("pregrasp_position_m", float64, 3),
    fixed("lift_position_m", float64, 3),
    fixed("tool_position_m", float64, 3),
    fixed("tool_quaternion_wxyz", float64, 4),
    fixed("tool_pregrasp_position_m", float64, 3),
    fixed("tool_lift_position_m", float64, 3),
    fixed("joints_rad", float64, 4),
    fixed("pregrasp_rad", float64, 4),
    {.name = "contacts", .type = record, .record = &kContact, .fixed = 3},
    fixed("approach", float64, 3),
    fixed("quality", float64, 9),
    one("object", int32),
    one("box", int32),
    one("face", int32),
};
constexpr WireLayout kGrasp{"grasp_t", kGraspFields};

constexpr WireField kBoxFields[] = {
    fixed("center_m", float64, 3),
    fixed("quaternion_wxyz", float64, 4),
    fixed("extents_m", float64, 3),
    one("points", int32),
    one("parent", int32),
    one("leaf", boolean),
    one("theta", float64),
    one("stop_reason", text),
    one("object", int32),
    one("shape", text),
    fixed("shape_center_m", float64, 3),
    fixed("shape_axis", float64, 3),
    one("shape_radius_m", float64),
};
constexpr WireLayout kBox{"box_t", kBoxFields};

constexpr WireField kStageFields[] = {
    one("name", text),
    one("num_in", int64),
    one("num_out", int64),
    one("time_s", float64),
};
constexpr WireLayout kStage{"stage_t", kStageFields};

constexpr WireField kRejectionFields[] = {one("reason", text), one("count", int64)};
constexpr WireLayout kRejection{"rejection_t", kRejectionFields};

constexpr WireField kRegionFields[] = {fixed("min_m", float64, 3), fixed("max_m", float64, 3)};
constexpr WireLayout kRegion{"region_t", kRegionFields};

constexpr WireField kViewpointFields[] = {fixed("position_m", float64, 3)};
constexpr WireLayout kViewpoint{"viewpoint_t", kViewpointFields};

constexpr WireField kSignatureFields[] = {fixed("key", byte, 32), fixed("bytes", byte, 64)};
constexpr WireLayout kSignature{"signature_t", kSignatureFields};

constexpr WireField kMetricFields[] = {one("name", text), one("value", float64)};
constexpr WireLayout kMetric{"metric_t", kMetricFields};

constexpr WireField kModelInfoFields[] = {
    one("version", text),
    one("name", text),
    one("state", text),
    one("reason", text),
    one("serving", boolean),
    one("pinned", boolean),
    one("key", text),
    one("accepted", int64),
    one("created", text),
    one("trained_on", text),
    one("command", text),
    one("data_hash", text),
    one("seed", int64),
    one("features", text),
    one("shape", text),
    one("num_metrics", int32),
    many("metrics", kMetric, "num_metrics", kMaxRows),
};
constexpr WireLayout kModelInfo{"model_info_t", kModelInfoFields};

constexpr WireField kCancelFields[] = {one("utime", int64), one("request_id", text)};

}  // namespace

constexpr WireLayout kPointCloud{"lcmt_point_cloud", kPointCloudFields};

namespace {

constexpr WireField kPlanRequestFields[] = {
    one("utime", int64),
    one("request_id", text),
    one("cloud", kPointCloud),
    one("top_k", int32),
    one("deadline_s", float64),
    one("friction", float64),
    one("object", int32),
    one("has_gravity", boolean),
    fixed("gravity", float64, 3),
    one("num_viewpoints", int32),
    many("viewpoints", kViewpoint, "num_viewpoints", std::int64_t{kMaxViewpoints}),
    one("has_table", boolean),
    fixed("table_point_m", float64, 3),
    fixed("table_normal", float64, 3),
    one("answer_frame", int8),
    one("has_camera_pose", boolean),
    fixed("camera_position_m", float64, 3),
    fixed("camera_quaternion_wxyz", float64, 4),
    one("has_approach", boolean),
    fixed("approach", float64, 3),
    one("approach_cone_rad", float64),
    one("has_workspace", boolean),
    fixed("workspace_min_m", float64, 3),
    fixed("workspace_max_m", float64, 3),
    one("num_forbidden", int32),
    many("forbidden", kRegion, "num_forbidden", kMaxRows),
};

constexpr WireField kPlanResponseFields[] = {
    one("utime", int64),        one("request_id", text),
    one("frame", text),         one("outcome", int8),
    one("message", text),       one("model_version", text),
    one("num_grasps", int32),   many("grasps", kGrasp, "num_grasps", kMaxCandidates),
    one("num_boxes", int32),    many("boxes", kBox, "num_boxes", kMaxCandidates),
    one("num_stages", int32),   many("stages", kStage, "num_stages", kMaxRows),
    one("num_rejected", int32), many("rejected", kRejection, "num_rejected", kMaxRows),
    one("num_notes", int32),    many("notes", text, "num_notes", kMaxRows),
    one("seed", int64),         one("time_s", float64),
};

constexpr WireField kStatusFields[] = {
    one("utime", int64),
    one("version", text),
    one("model_version", text),
    one("hand", text),
    one("uptime_s", float64),
    one("workers", int32),
    one("running", int32),
    one("queue_length", int32),
    one("queue_capacity", int32),
    one("overloaded", boolean),
    one("num_active", int32),
    many("active", text, "num_active", kMaxRows),
    fixed("outcomes", int64, 7),
    one("repeated", int64),
    one("superseded", int64),
    one("refused", int64),
    one("latency_p50_s", float64),
    one("latency_p90_s", float64),
    one("latency_p99_s", float64),
    one("receive_buffer_asked", int64),
    one("receive_buffer_granted", int64),
};

constexpr WireField kPublishModelFields[] = {
    one("utime", int64),
    one("request_id", text),
    one("signature", kSignature),
    one("model_size", int32),
    many("model", byte, "model_size", kMaxModelBytes),
};

constexpr WireField kModelReplyFields[] = {
    one("utime", int64),  one("request_id", text), one("outcome", int8),
    one("version", text), one("message", text),
};

constexpr WireField kModelsRequestFields[] = {
    one("utime", int64),  one("request_id", text),      one("action", int8),
    one("version", text), one("signature", kSignature),
};

constexpr WireField kModelsReplyFields[] = {
    one("utime", int64),  one("request_id", text),  one("done", boolean),
    one("message", text), one("num_models", int32), many("models", kModelInfo, "num_models", kMaxRows),
};

constexpr WireField kGraspOutcomeFields[] = {
    one("utime", int64),       one("request_id", text),
    one("grasp_index", int32), one("robot", text),
    one("succeeded", boolean), one("what", text),
    one("num_forces", int32),  many("forces_n", float64, "num_forces", kMaxRows),
};

constexpr WireField kOutcomeReplyFields[] = {
    one("utime", int64), one("request_id", text), one("grasp_index", int32),
    one("robot", text),  one("receipt", int8),    one("message", text),
};

constexpr WireField kRetrainRequestFields[] = {
    one("utime", int64),
    one("request_id", text),
    one("cancel", boolean),
    one("reason", text),
};

constexpr WireField kTrainingStatusFields[] = {
    one("utime", int64),
    one("worker", text),
    one("state", int8),
    one("request_id", text),
    one("cause", text),
    one("stage", text),
    one("progress", float64),
    one("remaining_s", float64),
    one("labels", int64),
    one("outcomes", int64),
    one("outcomes_waiting", int64),
    one("in_service", text),
    one("candidate", text),
    one("published", boolean),
    one("message", text),
};

}  // namespace

constexpr WireLayout kPlanRequest{"plan_request_t", kPlanRequestFields};
constexpr WireLayout kPlanResponse{"plan_response_t", kPlanResponseFields};
constexpr WireLayout kStatus{"status_t", kStatusFields};
constexpr WireLayout kCancel{"cancel_t", kCancelFields};
constexpr WireLayout kPublishModel{"publish_model_t", kPublishModelFields};
constexpr WireLayout kModelReply{"model_reply_t", kModelReplyFields};
constexpr WireLayout kModelsRequest{"models_request_t", kModelsRequestFields};
constexpr WireLayout kModelsReply{"models_reply_t", kModelsReplyFields};
constexpr WireLayout kGraspOutcome{"grasp_outcome_t", kGraspOutcomeFields};
constexpr WireLayout kOutcomeReply{"outcome_reply_t", kOutcomeReplyFields};
constexpr WireLayout kRetrainRequest{"retrain_request_t", kRetrainRequestFields};
constexpr WireLayout kTrainingStatus{"training_status_t", kTrainingStatusFields};

}  // namespace wire

namespace {

// LCM's names and sizes of the types, in the order of WireType. Text and records have no fixed size.
struct TypeText {
  std::string_view name;
  int bytes;
};
constexpr std::array<TypeText, 9> kTypes{{{"int8_t", 1},
                                          {"int16_t", 2},
                                          {"int32_t", 4},
                                          {"int64_t", 8},
                                          {"double", 8},
                                          {"byte", 1},
                                          {"boolean", 1},
                                          {"string", 0},
                                          {"", 0}}};
constexpr const TypeText& textOf(WireType type) { return kTypes[static_cast<std::size_t>(type)]; }

// The hash function of LCM's fingerprints, over signed 64-bit values with an arithmetic shift.
class FingerprintHash {
 public:
  void add(char c) { value_ = ((value_ << 8) ^ arithmeticShift(value_)) + static_cast<std::uint64_t>(c); }
  void add(std::string_view text) {
    add(static_cast<char>(text.size()));
    for (const char c : text) add(c);
  }
  void addDimension(const WireField& field) {
    const bool array = field.fixed > 0 || !field.count.empty();
    add(static_cast<char>(array));
    if (!array) return;
    add(static_cast<char>(field.fixed == 0));  // 1: the length stands in a member
    add(field.fixed > 0 ? std::to_string(field.fixed) : std::string(field.count));
  }
  std::uint64_t value() const { return value_; }

 private:
  static std::uint64_t arithmeticShift(std::uint64_t v) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(v) >> 55);
  }
  std::uint64_t value_ = 0x12345678;
};

}  // namespace

int wireBytes(WireType type) { return textOf(type).bytes; }

std::uint64_t wireFingerprint(const WireLayout& layout) {
  FingerprintHash own;
  std::uint64_t records = 0;
  for (const WireField& field : layout.fields) {
    own.add(field.name);
    if (field.type == WireType::record)
      records += wireFingerprint(*field.record);
    else
      own.add(textOf(field.type).name);
    own.addDimension(field);
  }
  const std::uint64_t sum = own.value() + records;
  return (sum << 1) + (sum >> 63);
}

std::int64_t minWireBytes(const WireLayout& layout) {
  std::int64_t bytes = 0;
  for (const WireField& field : layout.fields) {
    if (!field.count.empty()) continue;
    const std::int64_t each = field.type == WireType::record ? minWireBytes(*field.record)
                              : field.type == WireType::text ? kMinTextBytes
                                                             : wireBytes(field.type);
    bytes += each * (field.fixed > 0 ? field.fixed : 1);
  }
  return bytes;
}

}  // namespace boxgrasp
