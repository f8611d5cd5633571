// What robots report of the grasps that they were sent, and the answers that those grasps came from: what the
// daemon hears and the worker learns from.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "boxgrasp/store/store_error.h"

namespace boxgrasp {

class Database;

// What a model says of a grasp, and from what.
struct RememberedGrasp {
  std::vector<double> inputs;  // of the network, in the order of AnswerOrigin::features
  double score = NAN;
};

// What made the answer.
struct AnswerOrigin {
  std::string model_version;
  std::string features;  // of the model, joined by spaces
  std::string hand;
  std::string object;  // its label; empty: unknown
};

struct RememberedAnswer {
  std::string request_id;
  std::int64_t utime = 0;  // microseconds since 1970
  AnswerOrigin origin;
  std::vector<RememberedGrasp> grasps;  // by index in the answer
};

// A robot's report on one grasp of an answer.
struct RobotOutcome {
  std::string request_id;
  int grasp_index = -1;
  std::string robot;
  bool succeeded = false;
  std::string what;              // in the robot's words
  std::vector<double> forces_n;  // as measured; empty: not
  std::int64_t utime = 0;        // microseconds since 1970
  double weight = 1.0;           // in learning
};

enum class OutcomeReceipt {
  stored,
  duplicate,        // this robot said so before; counted once
  unknown_request,  // no such answer was given, or it was too long ago
  unknown_grasp,    // the answer has no grasp of this index
  conflicting,      // this robot said the opposite before, and that stays
};
std::string_view describe(OutcomeReceipt receipt);

// An outcome and what was predicted for it when it was reported.
struct StoredOutcome {
  std::int64_t id = 0;  // rises from report to report; never used again
  RobotOutcome outcome;
  AnswerOrigin origin;
  RememberedGrasp grasp;
};

struct OutcomeStoreOptions {
  // Answers remembered, about 2 kB each with ten grasps. Robots that report late or planners that are asked
  // often need more.
  int max_answers = 20'000;
  void validate() const;
};

// Used by several processes at once; each change is one transaction, and on the disk when the function
// returns. What is written reads back to the bit; of NaNs, that they are NaN. The errors, and who may use one
// object, are those of ExperienceStore.
class OutcomeStore {
 public:
  // Longer texts and more forces than this are refused with an InputError, because robots send them.
  static constexpr std::size_t kMaxTextBytes = 4096;
  static constexpr std::size_t kMaxForces = 64;

  // Creates the file where there is none.
  explicit OutcomeStore(const std::filesystem::path& file, const OutcomeStoreOptions& options = {});
  OutcomeStore(OutcomeStore&&) noexcept;
  OutcomeStore& operator=(OutcomeStore&&) noexcept;
  ~OutcomeStore();

  // Takes the place of an earlier answer to the same request. Beyond max_answers others are forgotten: of the
  // older half those without outcomes, the oldest first, and then those with. Outcomes stay.
  void rememberAnswer(const RememberedAnswer& answer);

  // A report is the same as an earlier one when robot, request and grasp are.
  OutcomeReceipt addOutcome(const RobotOutcome& outcome);

  // Those with ids greater than `after`, oldest first.
  std::vector<StoredOutcome> outcomesAfter(std::int64_t after) const;
  std::int64_t countAfter(std::int64_t after) const;
  std::int64_t answers() const;  // remembered

  // The worker's notes, such as the last id that it has learnt from.
  void setProgress(const std::string& name, const std::string& value);
  std::optional<std::string> progress(const std::string& name) const;

 private:
  OutcomeStoreOptions options_;
  std::unique_ptr<Database> database_;
};

}  // namespace boxgrasp
