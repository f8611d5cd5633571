#include "boxgrasp/store/experience_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cctype>

#include "boxgrasp/ranking/model_file.h"
#include "boxgrasp/store/experience_columns.h"
#include "boxgrasp/store/file_lock.h"
#include "boxgrasp/store/number_text.h"

namespace boxgrasp {
namespace {

constexpr FileKind kKind{
    "experience store", 0x62786578, 1,
    "CREATE TABLE settings (one INTEGER PRIMARY KEY CHECK (one = 1), content TEXT NOT NULL) STRICT;"
    "CREATE TABLE models (model INTEGER PRIMARY KEY,"
    " object TEXT NOT NULL, scale REAL NOT NULL CHECK (scale > 0), view TEXT NOT NULL, mesh_hash TEXT NOT "
    "NULL,"
    " mass_kg ANY, size_m ANY, boxes INTEGER NOT NULL, leaves INTEGER NOT NULL,"
    " projections INTEGER NOT NULL, triplets INTEGER NOT NULL, configurations INTEGER NOT NULL,"
    " message TEXT NOT NULL, UNIQUE (object, scale, view)) STRICT;"
    "CREATE TABLE hypotheses (hypothesis INTEGER PRIMARY KEY,"
    " model INTEGER NOT NULL REFERENCES models, source TEXT NOT NULL, grasp_index INTEGER NOT NULL CHECK "
    "(grasp_index >= 0),"
    " X_OP TEXT NOT NULL, joints TEXT NOT NULL, pregrasp TEXT NOT NULL, approach_m ANY,"
    " q1 ANY, q2 ANY, q3 ANY, q4 ANY, q5 ANY, q6 ANY, q7 ANY, q8 ANY, q9 ANY,"
    " box INTEGER NOT NULL, face INTEGER NOT NULL, UNIQUE (model, source, grasp_index)) STRICT;"
    "CREATE TABLE labels (hypothesis INTEGER NOT NULL REFERENCES hypotheses,"
    " perturbation INTEGER NOT NULL CHECK (perturbation >= 0), seed INTEGER NOT NULL, friction ANY, "
    "mass_factor ANY,"
    " outcome TEXT NOT NULL, force_closure INTEGER NOT NULL, epsilon ANY, nu ANY, lift_slip_m ANY,"
    " lift_rotation_rad ANY, push_force_n ANY, six_push_displacement_m ANY,"
    " gravities_held INTEGER NOT NULL, contacts TEXT NOT NULL,"
    " PRIMARY KEY (hypothesis, perturbation)) STRICT;",
    "restore it from a copy, or move it away and label again"};

constexpr std::array kSources{GraspSource::planner, GraspSource::random, GraspSource::approach};

// Takes the lock before the file is touched.
std::unique_ptr<FileLock> lockForWriting(const std::filesystem::path& file) {
  auto lock = std::make_unique<FileLock>(file);
  if (lock->tryLock()) return lock;
  throw StoreError(fmt::format(
      "{} '{}' is being written by another process; wait for its end, or give this one another file, to "
      "merge the two later",
      kKind.name, file.string()));
}

// Names the first line that differs.
void requireSameSettings(const std::string& title, std::string_view stored, std::string_view given) {
  if (stored == given) return;
  for (int line = 1;; ++line) {
    const std::string_view is = takeFirst(stored, '\n'), wanted = takeFirst(given, '\n');
    if (is == wanted && !(stored.empty() && given.empty())) continue;
    throw InputError(
        fmt::format("{} was made with other settings: line {} is '{}' there, and '{}' here; give "
                    "the same options as then, or another file",
                    title, line, is, wanted));
  }
}

// Keys must come back from the names of their grasps, which stand on one line.
void requireNameable(const ModelKey& key) {
  const std::string name = formatModelKey(key);
  const bool printable = std::ranges::none_of(name, [](unsigned char c) { return std::iscntrl(c) != 0; });
  if (printable && parseModelKey(name) == key) return;
  throw InputError(
      fmt::format("{:?} cannot name a model: neither object nor view may hold control characters, "
                  "nor the view a '/'",
                  name));
}

// A table in which a key says at most one thing.
template <typename Record>
class Table {
 public:
  // `key`: the condition that finds the row of a record.
  Table(const Database& database, const char* table, const std::vector<std::string>& owners, const char* key)
      : database_(database),
        insert_(database, insertStatement<Record>(table, owners) + " ON CONFLICT DO NOTHING"),
        find_(database, fmt::format("SELECT {} FROM {} WHERE {}", columnList<Record>(), table, key)) {}

  // False where the record is there already. Throws InputError where it is with other content.
  bool add(const std::vector<Value>& owners, const std::vector<Value>& key, const Record& record,
           const std::string& name) {
    insert_.bind(valuesOf(record, owners)).step();
    if (database_.changedRows() > 0) return true;
    find_.bind(key).step();
    requireSame(difference(readRecord<Record>(find_, 0), record), name);
    return false;
  }

 private:
  void requireSame(const std::string& difference, const std::string& name) const {
    if (difference.empty()) return;
    throw InputError(
        fmt::format("{} has {} already, with other content: {}; keep what was made in different "
                    "ways in different stores",
                    database_.title(), name, difference));
  }

  const Database& database_;
  Statement insert_, find_;
};

std::vector<Value> valuesOfKey(const ModelKey& key) {
  return {encode(key.object), encode(key.scale), encode(key.view)};
}
constexpr const char* kOfModel = "object = ? AND scale = ? AND view = ?";

std::int64_t modelRow(const Database& database, const ModelKey& key) {
  Statement row(database, fmt::format("SELECT model FROM models WHERE {}", kOfModel));
  if (row.bind(valuesOfKey(key)).step()) return row.integer(0);
  throw InputError(fmt::format("{} knows no model '{}'", database.title(), formatModelKey(key)));
}

void put(const Database& database, const ModelRecord& model, const std::vector<HypothesisRecord>& hypotheses,
         MergeCounts& added) {
  const std::string name = formatModelKey(model.key);
  added.models +=
      Table<ModelRecord>(database, "models", {}, kOfModel).add({}, valuesOfKey(model.key), model, name);
  const Value row = modelRow(database, model.key);
  Table<HypothesisRecord> table(database, "hypotheses", {"model"},
                                "model = ? AND source = ? AND grasp_index = ?");
  for (const HypothesisRecord& grasp : hypotheses) {
    added.hypotheses += table.add({row}, {row, encode(grasp.source), encode(grasp.index)}, grasp,
                                  formatGraspId({model.key, grasp.source, grasp.index}));
  }
}

void putLabels(const Database& database, const ModelKey& key, GraspSource source,
               const std::vector<IndexedLabel>& labels, MergeCounts& added) {
  const Value model = modelRow(database, key);
  Statement grasp(database,
                  "SELECT hypothesis FROM hypotheses WHERE model = ? AND source = ? AND grasp_index = ?");
  Table<GraspLabel> table(database, "labels", {"hypothesis"}, "hypothesis = ? AND perturbation = ?");
  for (const auto& [index, label] : labels) {
    const std::string name = formatGraspId({key, source, index});
    if (!grasp.bind({model, encode(source), encode(index)}).step())
      throw InputError(fmt::format("{} knows no grasp '{}'", database.title(), name));
    const Value row = grasp.value(0);
    added.labels += table.add({row}, {row, encode(label.perturbation)}, label,
                              fmt::format("label {} of {}", label.perturbation, name));
  }
}

// The labels of hypotheses as a list.
std::vector<IndexedLabel> flat(const std::vector<LabelledHypothesis>& labelled) {
  std::vector<IndexedLabel> labels;
  for (const auto& [hypothesis, of_it] : labelled) {
    for (const GraspLabel& label : of_it) labels.push_back({hypothesis.index, label});
  }
  return labels;
}

std::vector<HypothesisRecord> allHypotheses(const ExperienceStore& store, const ModelKey& key) {
  std::vector<HypothesisRecord> all;
  for (const GraspSource source : kSources) {
    for (HypothesisRecord& grasp : store.hypotheses(key, source)) all.push_back(std::move(grasp));
  }
  return all;
}

using WriteLine = std::function<void(std::string_view)>;

void dumpSettings(std::string_view settings, const WriteLine& write) {
  while (!settings.empty()) write(fmt::format("setting {}", takeFirst(settings, '\n')));
}

void dumpModel(const ExperienceStore& store, const ModelRecord& model, const WriteLine& write) {
  write(fmt::format("model {}{}", formatModelKey(model.key), recordText(model)));
  for (const HypothesisRecord& grasp : allHypotheses(store, model.key)) {
    write(
        fmt::format("grasp {}{}", formatGraspId({model.key, grasp.source, grasp.index}), recordText(grasp)));
  }
  for (const GraspSource source : kSources) {
    for (const auto& [index, label] : flat(store.labelled(model.key, source)))
      write(fmt::format("label {}{}", formatGraspId({model.key, source, index}), recordText(label)));
  }
}

LabelCounts readCounts(const Statement& row) {
  LabelCounts counts;
  row.read(0, counts.model.object);
  row.read(1, counts.model.scale);
  row.read(2, counts.model.view);
  row.read(3, counts.source);
  counts.hypotheses = row.integer(4);
  counts.labels = row.integer(5);
  for (int i = 0; i < static_cast<int>(counts.outcomes.size()); ++i) counts.outcomes[i] = row.integer(6 + i);
  return counts;
}

}  // namespace

ExperienceStore::ExperienceStore(std::unique_ptr<FileLock> lock, std::unique_ptr<Database> database)
    : lock_(std::move(lock)), database_(std::move(database)) {
  Statement row(*database_, "SELECT content FROM settings");
  if (row.step()) row.read(0, settings_);
}

ExperienceStore::ExperienceStore(ExperienceStore&&) noexcept = default;
ExperienceStore& ExperienceStore::operator=(ExperienceStore&&) noexcept = default;
ExperienceStore::~ExperienceStore() = default;

ExperienceStore ExperienceStore::openForWriting(const std::filesystem::path& file,
                                                const std::string& settings) {
  auto lock = lockForWriting(file);
  auto database = std::make_unique<Database>(file, kKind, Database::Access::write);
  Statement(*database, "INSERT INTO settings VALUES (1, ?) ON CONFLICT DO NOTHING").bind({settings}).step();
  ExperienceStore store(std::move(lock), std::move(database));
  requireSameSettings(store.database_->title(), store.settings_, settings);
  return store;
}

ExperienceStore ExperienceStore::openForReading(const std::filesystem::path& file) {
  return {nullptr, std::make_unique<Database>(file, kKind, Database::Access::read)};
}

void ExperienceStore::addModel(const ModelRecord& model, const std::vector<HypothesisRecord>& hypotheses) {
  requireNameable(model.key);
  const Transaction transaction(*database_, Transaction::Purpose::write);
  MergeCounts added;
  put(*database_, model, hypotheses, added);
  transaction.commit();
}

std::vector<ModelRecord> ExperienceStore::models() const {
  std::vector<ModelRecord> models;
  Statement row(*database_,
                fmt::format("SELECT {} FROM models ORDER BY object, scale, view", columnList<ModelRecord>()));
  while (row.step()) models.push_back(readRecord<ModelRecord>(row, 0));
  return models;
}

std::optional<ModelRecord> ExperienceStore::model(const ModelKey& key) const {
  Statement row(*database_,
                fmt::format("SELECT {} FROM models WHERE {}", columnList<ModelRecord>(), kOfModel));
  if (!row.bind(valuesOfKey(key)).step()) return std::nullopt;
  return readRecord<ModelRecord>(row, 0);
}

std::vector<HypothesisRecord> ExperienceStore::hypotheses(const ModelKey& key, GraspSource source) const {
  std::vector<HypothesisRecord> hypotheses;
  Statement row(*database_, fmt::format("SELECT {} FROM hypotheses WHERE model = ? AND source = ? "
                                        "ORDER BY grasp_index",
                                        columnList<HypothesisRecord>()));
  row.bind({modelRow(*database_, key), encode(source)});
  while (row.step()) hypotheses.push_back(readRecord<HypothesisRecord>(row, 0));
  return hypotheses;
}

void ExperienceStore::addLabels(const ModelKey& key, GraspSource source,
                                const std::vector<IndexedLabel>& labels) {
  const Transaction transaction(*database_, Transaction::Purpose::write);
  MergeCounts added;
  putLabels(*database_, key, source, labels, added);
  transaction.commit();
}

std::vector<LabelledHypothesis> ExperienceStore::labelled(const ModelKey& key, GraspSource source) const {
  std::vector<LabelledHypothesis> labelled;
  Statement row(*database_,
                fmt::format("SELECT grasp_index, {}, {} FROM hypotheses JOIN labels USING (hypothesis) "
                            "WHERE model = ? AND source = ? ORDER BY grasp_index, perturbation",
                            columnList<GraspLabel>(), columnList<HypothesisRecord>()));
  row.bind({modelRow(*database_, key), encode(source)});
  const int after_label = 1 + static_cast<int>(columnNames<GraspLabel>().size());
  while (row.step()) {
    if (labelled.empty() || labelled.back().hypothesis.index != row.integer(0))
      labelled.push_back({readRecord<HypothesisRecord>(row, after_label), {}});
    labelled.back().labels.push_back(readRecord<GraspLabel>(row, 1));
  }
  return labelled;
}

std::vector<LabelSlot> ExperienceStore::missing(const ModelKey& key, GraspSource source,
                                                int perturbations) const {
  std::vector<LabelSlot> missing;
  Statement row(*database_,
                "WITH RECURSIVE wanted (perturbation) AS"
                " (SELECT 0 UNION ALL SELECT perturbation + 1 FROM wanted WHERE perturbation < ?)"
                "SELECT grasp_index, wanted.perturbation FROM hypotheses JOIN wanted "
                "WHERE model = ? AND source = ? AND NOT EXISTS (SELECT 1 FROM labels WHERE"
                " labels.hypothesis = hypotheses.hypothesis AND labels.perturbation = wanted.perturbation) "
                "ORDER BY grasp_index, wanted.perturbation");
  row.bind({encode(perturbations), modelRow(*database_, key), encode(source)});
  while (row.step()) {
    LabelSlot& slot = missing.emplace_back();
    row.read(0, slot.index);
    row.read(1, slot.perturbation);
  }
  return missing;
}

std::vector<LabelCounts> ExperienceStore::counts() const {
  std::string outcomes;
  for (std::size_t i = 0; i < LabelCounts{}.outcomes.size(); ++i) {
    outcomes += fmt::format(", count(*) FILTER (WHERE perturbation = 0 AND outcome = '{}')",
                            describe(static_cast<TrialOutcome>(i)));
  }
  Statement row(*database_,
                fmt::format("SELECT object, scale, view, source,"
                            " count(DISTINCT hypotheses.hypothesis), count(perturbation) {} "
                            "FROM models JOIN hypotheses USING (model) LEFT JOIN labels USING (hypothesis) "
                            "GROUP BY object, scale, view, source ORDER BY object, scale, view, source",
                            outcomes));
  std::vector<LabelCounts> counts;
  while (row.step()) counts.push_back(readCounts(row));
  return counts;
}

MergeCounts ExperienceStore::merge(const ExperienceStore& from) {
  requireSameSettings(database_->title(), settings_, from.settings_);
  const Transaction snapshot(*from.database_, Transaction::Purpose::read);
  MergeCounts added;
  for (const ModelRecord& model : from.models()) {
    requireNameable(model.key);
    const Transaction transaction(*database_, Transaction::Purpose::write);
    put(*database_, model, allHypotheses(from, model.key), added);
    for (const GraspSource source : kSources) {
      putLabels(*database_, model.key, source, flat(from.labelled(model.key, source)), added);
    }
    transaction.commit();
  }
  return added;
}

void ExperienceStore::dump(const WriteLine& write) const {
  const Transaction snapshot(*database_, Transaction::Purpose::read);
  dumpSettings(settings_, write);
  for (const ModelRecord& model : models()) dumpModel(*this, model, write);
}

std::string ExperienceStore::contentHash() const {
  std::string hashes;
  dump([&](std::string_view line) { hashes += blake2bHex(line); });
  return blake2bHex(hashes);
}

}  // namespace boxgrasp
