// How messages are laid out in bytes: what has to be known to check them before they are decoded.
//
// The tables repeat the .lcm files of lcmtypes/. They cannot drift apart from them unseen: LCM's fingerprint
// is computed from exactly what a table says, and the tests hold it against the generated one.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace boxgrasp {

enum class WireType { int8, int16, int32, int64, float64, byte, boolean, text, record };

struct WireLayout;

// One member. An array's length stands in an earlier integer member, or is fixed; others are single values.
struct WireField {
  std::string_view name;
  WireType type;
  const WireLayout* record = nullptr;  // of WireType::record
  std::string_view count = {};         // name of the member with the array's length
  int fixed = 0;                       // the array's fixed length
  std::int64_t cap = 0;                // the largest legal length of an array with a count
};

struct WireLayout {
  std::string_view name;
  std::span<const WireField> fields;
};

namespace wire {

extern const WireLayout kPointCloud;  // drake::lcmt_point_cloud
extern const WireLayout kPlanRequest;
extern const WireLayout kPlanResponse;
extern const WireLayout kStatus;
extern const WireLayout kCancel;
extern const WireLayout kPublishModel;
extern const WireLayout kModelReply;
extern const WireLayout kModelsRequest;
extern const WireLayout kModelsReply;
extern const WireLayout kGraspOutcome;
extern const WireLayout kOutcomeReply;
extern const WireLayout kRetrainRequest;
extern const WireLayout kTrainingStatus;

}  // namespace wire

inline constexpr std::int64_t kMaxMessageBytes = std::int64_t{1} << 28;  // LCM's receivers drop larger ones
inline constexpr std::int64_t kMaxModelBytes = std::int64_t{32} << 20;   // what model files may have
inline constexpr std::int64_t kMinTextBytes = 5;        // an empty string: its length and its end mark
inline constexpr std::int64_t kMaxTextBytes = 1 << 16;  // of one string, with its end mark

// LCM's fingerprint of the type: a hash of the members' names, types and array dimensions.
std::uint64_t wireFingerprint(const WireLayout& layout);

// The least number of bytes that a value of this layout takes, without a fingerprint.
std::int64_t minWireBytes(const WireLayout& layout);

// The bytes of one value of a type that is neither text nor record.
int wireBytes(WireType type);

}  // namespace boxgrasp
