// The labels of simulated grasps, in one SQLite file: models, what was tried on them, and what came of it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "boxgrasp/store/grasp_id.h"
#include "boxgrasp/store/store_error.h"
#include "boxgrasp/training/experience.h"

namespace boxgrasp {

class Database;
class FileLock;

// A label that is still to be made.
struct LabelSlot {
  int index = -1;        // of the hypothesis
  int perturbation = 0;  // as in GraspLabel
  auto operator<=>(const LabelSlot&) const = default;
};

// A label and the hypothesis that it belongs to.
struct IndexedLabel {
  int index = -1;
  GraspLabel label;
};

// What a store holds of one model and source.
struct LabelCounts {
  ModelKey model;
  GraspSource source = GraspSource::planner;
  std::int64_t hypotheses = 0;
  std::int64_t labels = 0;                 // of all perturbations
  std::array<std::int64_t, 6> outcomes{};  // by TrialOutcome, of the labels as planned (perturbation 0)
};

// How much `merge` has added.
struct MergeCounts {
  std::int64_t models = 0, hypotheses = 0, labels = 0;
};

// One writer at a time, any number of readers beside it, in any process. Every change is one transaction:
// once a function has returned, what it wrote outlives the process and the machine's power; a process killed
// in the middle leaves what was there before. What is written reads back to the bit; of NaNs, that they are
// NaN.
//
// All functions throw StoreError, whose message names the file, what happened and what to do: a full disk, an
// error of the disk, a file that is damaged, that is no store of this kind, or that a newer version wrote.
// The file is then as before the call.
//
// A store is used by one thread at a time, and not across fork().
class ExperienceStore {
 public:
  // `settings`: all that labels depend on besides the model (options, seed, hand, code version) as canonical
  // text, one "name = value" a line, because labels of two kinds must not mix. Creates the file where there
  // is none. Throws InputError when another process writes to it, and, naming the first line that differs,
  // when it was made with other settings.
  static ExperienceStore openForWriting(const std::filesystem::path& file, const std::string& settings);

  // Sees what is complete, also while another process writes; on a read-only file system too, once the writer
  // has closed the store. Throws InputError for a file that is not there.
  static ExperienceStore openForReading(const std::filesystem::path& file);

  ExperienceStore(ExperienceStore&&) noexcept;
  ExperienceStore& operator=(ExperienceStore&&) noexcept;
  ~ExperienceStore();

  const std::string& settings() const { return settings_; }

  // Adds the model and hypotheses on it, of any sources, in one transaction; more can follow in later calls
  // with the same model. What is there already is left alone; throws InputError, naming the first field that
  // differs, when it is there with other content, and for a key that cannot name grasps (GraspId).
  void addModel(const ModelRecord& model, const std::vector<HypothesisRecord>& hypotheses);

  std::vector<ModelRecord> models() const;  // ordered by key
  std::optional<ModelRecord> model(const ModelKey& key) const;

  // This and all that follows throws InputError for a model that is not there.
  std::vector<HypothesisRecord> hypotheses(const ModelKey& key, GraspSource source) const;  // by index

  // In one transaction. What is there already is left alone; throws InputError that names the grasp and the
  // first field that differs when it is there with other content, or names the grasp when it is not known.
  void addLabels(const ModelKey& key, GraspSource source, const std::vector<IndexedLabel>& labels);

  // Every hypothesis that has labels, by index; its labels by perturbation. There may be gaps in both while
  // labelling goes on: GraspLabel::perturbation says which one it is.
  std::vector<LabelledHypothesis> labelled(const ModelKey& key, GraspSource source) const;

  // The labels 0 .. `perturbations` of every hypothesis that are not there yet, by index and perturbation.
  std::vector<LabelSlot> missing(const ModelKey& key, GraspSource source, int perturbations) const;

  // One for each model and source with hypotheses, in the order of their names.
  std::vector<LabelCounts> counts() const;

  // Adds what the other store has and this one has not, one transaction a model: merging again, or once more
  // after a kill, changes nothing. Throws InputError for other settings, or naming what is there with other
  // content.
  MergeCounts merge(const ExperienceStore& from);

  // The content as text, line by line in the order of keys, every number in full: equal for stores of equal
  // content, however they came about.
  void dump(const std::function<void(std::string_view line)>& write) const;
  std::string contentHash() const;  // of the dump, 64 hex digits

 private:
  ExperienceStore(std::unique_ptr<FileLock> lock, std::unique_ptr<Database> database);
  std::unique_ptr<FileLock> lock_;  // null for readers
  std::unique_ptr<Database> database_;
  std::string settings_;
};

}  // namespace boxgrasp
