#include "boxgrasp/store/outcome_store.h"

#include <fmt/format.h>

#include <algorithm>

#include "boxgrasp/store/file_lock.h"
#include "boxgrasp/store/outcome_columns.h"

namespace boxgrasp {
namespace {

constexpr FileKind kKind{
    "outcome store", 0x62786f75, 1,
    "CREATE TABLE answers (answer INTEGER PRIMARY KEY AUTOINCREMENT, request_id TEXT NOT NULL UNIQUE,"
    " utime INTEGER NOT NULL, model_version TEXT NOT NULL, features TEXT NOT NULL, hand TEXT NOT NULL, "
    "object TEXT NOT NULL,"
    " reported INTEGER NOT NULL DEFAULT 0) STRICT;"
    "CREATE TABLE answered_grasps (answer INTEGER NOT NULL REFERENCES answers ON DELETE CASCADE,"
    " grasp_index INTEGER NOT NULL,"
    " inputs TEXT NOT NULL, score ANY,"
    " PRIMARY KEY (answer, grasp_index)) STRICT, WITHOUT ROWID;"
    // What was predicted is copied here, because answers are replaced and forgotten.
    "CREATE TABLE outcomes (id INTEGER PRIMARY KEY AUTOINCREMENT, request_id TEXT NOT NULL,"
    " grasp_index INTEGER NOT NULL, robot TEXT NOT NULL, succeeded INTEGER NOT NULL, what TEXT NOT NULL,"
    " forces_n TEXT NOT NULL, utime INTEGER NOT NULL, weight ANY,"
    " model_version TEXT NOT NULL, features TEXT NOT NULL, hand TEXT NOT NULL, object TEXT NOT NULL,"
    " inputs TEXT NOT NULL, score ANY,"
    " UNIQUE (request_id, grasp_index, robot)) STRICT;"
    "CREATE TABLE progress (name TEXT NOT NULL PRIMARY KEY, value TEXT NOT NULL) STRICT;",
    "restore it from a copy, or move it away to begin a new one"};

void requireShort(const char* field, const std::string& text) {
  if (text.size() <= OutcomeStore::kMaxTextBytes) return;
  throw InputError(fmt::format("'{}' is a text of {} bytes; give at most {}", field, text.size(),
                               OutcomeStore::kMaxTextBytes));
}

template <typename Record>
void requireShortTexts(const Record& record) {
  visitColumns(record, [](const char* name, const auto& field) {
    if constexpr (IsA<std::remove_reference_t<decltype(field)>, std::string>) requireShort(name, field);
  });
}

void requireFewForces(const std::vector<double>& forces_n) {
  if (forces_n.size() <= OutcomeStore::kMaxForces) return;
  throw InputError(
      fmt::format("'forces_n' has {} values; give at most {}", forces_n.size(), OutcomeStore::kMaxForces));
}

// Two processes may find that there is no file yet: one after the other makes it, or finds it made.
std::unique_ptr<Database> open(const std::filesystem::path& file) {
  const FileLock lock(file);
  lock.lock();
  return std::make_unique<Database>(file, kKind, Database::Access::write);
}

void insertAnswer(const Database& database, const RememberedAnswer& answer) {
  Statement(database, "DELETE FROM answers WHERE request_id = ?").bind({answer.request_id}).step();
  Statement(database, insertStatement<RememberedAnswer>("answers", {})).bind(valuesOf(answer)).step();
  const Value row = database.lastRow();
  Statement insert(database, insertStatement<RememberedGrasp>("answered_grasps", {"answer", "grasp_index"}));
  for (std::int64_t index = 0; const RememberedGrasp& grasp : answer.grasps) {
    insert.bind(valuesOf(grasp, {row, index++})).step();
  }
}

std::int64_t count(const Database& database, const char* sql, const std::vector<Value>& values) {
  Statement row(database, sql);
  row.bind(values).step();
  return row.integer(0);
}

// The younger half is safe, so that a robot has time to report however many answers have outcomes already.
void forgetBeyond(const Database& database, std::int64_t max_answers) {
  const std::int64_t answers = count(database, "SELECT count(*) FROM answers", {}),
                     excess = answers - max_answers;
  if (excess <= 0) return;
  Statement(database,
            "DELETE FROM answers WHERE answer IN (SELECT answer FROM"
            " (SELECT answer, reported FROM answers ORDER BY answer LIMIT ?)"
            " ORDER BY reported, answer LIMIT ?)")
      .bind({std::max(excess, answers / 2), excess})
      .step();
}

// What this robot said of this grasp before.
std::optional<OutcomeReceipt> compareWithEarlier(const Database& database, const RobotOutcome& outcome) {
  Statement row(database,
                "SELECT succeeded FROM outcomes WHERE request_id = ? AND grasp_index = ? AND robot = ?");
  if (!row.bind({outcome.request_id, encode(outcome.grasp_index), outcome.robot}).step()) return std::nullopt;
  bool succeeded = false;
  row.read(0, succeeded);
  return succeeded == outcome.succeeded ? OutcomeReceipt::duplicate : OutcomeReceipt::conflicting;
}

OutcomeReceipt insertOutcome(const Database& database, const RobotOutcome& outcome) {
  Statement answer(database, fmt::format("SELECT answer, {} FROM answers WHERE request_id = ?",
                                         columnList<AnswerOrigin>()));
  if (!answer.bind({outcome.request_id}).step()) return OutcomeReceipt::unknown_request;
  const Value row = answer.value(0);
  Statement grasp(database, fmt::format("SELECT {} FROM answered_grasps WHERE answer = ? AND grasp_index = ?",
                                        columnList<RememberedGrasp>()));
  if (!grasp.bind({row, encode(outcome.grasp_index)}).step()) return OutcomeReceipt::unknown_grasp;
  const StoredOutcome stored{0, outcome, readRecord<AnswerOrigin>(answer, 1),
                             readRecord<RememberedGrasp>(grasp, 0)};
  Statement(database, insertStatement<StoredOutcome>("outcomes", {})).bind(valuesOf(stored)).step();
  Statement(database, "UPDATE answers SET reported = 1 WHERE answer = ?").bind({row}).step();
  return OutcomeReceipt::stored;
}

}  // namespace

std::string_view describe(OutcomeReceipt receipt) {
  switch (receipt) {
    case OutcomeReceipt::stored:
      return "stored";
    case OutcomeReceipt::duplicate:
      return "duplicate";
    case OutcomeReceipt::unknown_request:
      return "unknown request";
    case OutcomeReceipt::unknown_grasp:
      return "unknown grasp";
    case OutcomeReceipt::conflicting:
      return "conflicting";
  }
  return "unknown";
}

void OutcomeStoreOptions::validate() const {
  requireOption(max_answers >= 1 && max_answers <= 10'000'000, "max_answers", max_answers, "1 to 10000000");
}

OutcomeStore::OutcomeStore(const std::filesystem::path& file, const OutcomeStoreOptions& options)
    : options_(options) {
  options.validate();
  database_ = open(file);
}

OutcomeStore::OutcomeStore(OutcomeStore&&) noexcept = default;
OutcomeStore& OutcomeStore::operator=(OutcomeStore&&) noexcept = default;
OutcomeStore::~OutcomeStore() = default;

void OutcomeStore::rememberAnswer(const RememberedAnswer& answer) {
  requireShortTexts(answer);
  const Transaction transaction(*database_, Transaction::Purpose::write);
  insertAnswer(*database_, answer);
  forgetBeyond(*database_, options_.max_answers);
  transaction.commit();
}

OutcomeReceipt OutcomeStore::addOutcome(const RobotOutcome& outcome) {
  requireShortTexts(outcome);
  requireFewForces(outcome.forces_n);
  const Transaction transaction(*database_, Transaction::Purpose::write);
  if (const auto earlier = compareWithEarlier(*database_, outcome)) return *earlier;
  const OutcomeReceipt receipt = insertOutcome(*database_, outcome);
  transaction.commit();
  return receipt;
}

std::vector<StoredOutcome> OutcomeStore::outcomesAfter(std::int64_t after) const {
  std::vector<StoredOutcome> outcomes;
  Statement row(*database_, fmt::format("SELECT id, {} FROM outcomes WHERE id > ? ORDER BY id",
                                        columnList<StoredOutcome>()));
  row.bind({after});
  while (row.step()) {
    outcomes.push_back(readRecord<StoredOutcome>(row, 1));
    outcomes.back().id = row.integer(0);
  }
  return outcomes;
}

std::int64_t OutcomeStore::countAfter(std::int64_t after) const {
  return count(*database_, "SELECT count(*) FROM outcomes WHERE id > ?", {after});
}

std::int64_t OutcomeStore::answers() const { return count(*database_, "SELECT count(*) FROM answers", {}); }

void OutcomeStore::setProgress(const std::string& name, const std::string& value) {
  Statement(*database_, "INSERT INTO progress VALUES (?, ?) ON CONFLICT DO UPDATE SET value = excluded.value")
      .bind({name, value})
      .step();
}

std::optional<std::string> OutcomeStore::progress(const std::string& name) const {
  Statement row(*database_, "SELECT value FROM progress WHERE name = ?");
  if (!row.bind({name}).step()) return std::nullopt;
  std::string value;
  row.read(0, value);
  return value;
}

}  // namespace boxgrasp
