// What `train` and `evaluate` have in common: labelled grasps, the networks to learn from them, and what
// these are worth on objects that they have never seen.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "boxgrasp/base/stop_token.h"
#include "boxgrasp/training/learning.h"
#include "boxgrasp/training/ranking_verdict.h"

namespace boxgrasp {

struct StudyCommand {
  std::optional<std::filesystem::path>
      store;                         // simulated labels; none: labels computed from planned contacts
  std::string meshes = "builtin";    // where the store's objects come from; or a folder
  int views = 0;                     // as when the store was labelled
  std::vector<std::string> objects;  // names; empty: all
  std::size_t points = 30'000;       // on each object, without a store
  std::string target = "s";          // or "hold", "both"
  std::string inputs;  // "paper", "relative", "all", or features separated by commas; empty: what ranks best
  std::vector<int> hidden = {2};
  int networks = 10;
  int starts = 1;    // of each network
  int repeats = 10;  // of the leave-one-object-out validation
  std::uint64_t seed = 1;
  int threads = 0;             // 0 = all cores; results do not depend on it
  bool recollections = false;  // models remember the objects too, for the planner's [recall]; needs a store
  std::optional<std::filesystem::path> hand;
};

struct StudyData {
  std::vector<std::string> features;
  std::vector<GraspList> lists;
  LearningTarget target = LearningTarget::success;
  std::string labels;  // in words
  GroupedSamples samples;
};

// Reads or makes the labels. Throws InputError.
StudyData studyData(const StudyCommand& command, const StopToken& stop);

LearningOptions learningOptions(const StudyCommand& command, LearningTarget target);

CrossValidationOptions validationOptions(const StudyCommand& command, LearningTarget target, int repeats);

// A ranking by networks that have not seen the object, beside what needs no learning.
struct StudyResult {
  CrossValidation validation;
  RankingVerdict network, chance;
  std::optional<RankingVerdict> recalled;  // the network's, corrected by what became of grasps on the other
                                           // objects; where their places are known
  std::vector<RankingVerdict> measures;    // the best first
  std::optional<Reliability> reliability;  // where the target is a probability
};
StudyResult evaluated(const StudyCommand& command, const StudyData& data, const StopToken& stop);

// What a model may remember: `foretold` by networks that had not seen the objects, a row for each sample.
// Empty unless asked for.
std::vector<RememberedList> remembered(const StudyCommand& command, const StudyData& data,
                                       const VectorXd& foretold);

// The best of the nine measures, which is what the paper's network has to beat.
const RankingVerdict& bestOfNine(const std::vector<RankingVerdict>& measures);

// The table that both commands print.
std::string verdictTable(const StudyResult& result);

}  // namespace boxgrasp
