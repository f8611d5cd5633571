#include "boxgrasp/store/database.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <array>
#include <cassert>
#include <cctype>
#include <cstring>
#include <map>
#include <mutex>

namespace boxgrasp {
namespace {

constexpr int kBusyTimeoutMs = 20'000;
constexpr int kMaxValueBytes = 16 << 20;  // no row of ours comes near

struct Trouble {
  int code;
  const char* cause;
  const char* remedy;
};
constexpr std::array kTroubles{
    Trouble{SQLITE_FULL, "the disk is full",
            "free some space and run the command again; what was stored before is intact"},
    Trouble{SQLITE_IOERR, "reading or writing failed",
            "check the disk and its quota, then run the command again; what was stored before is intact"},
    Trouble{SQLITE_BUSY, "another process keeps it locked", "let that process end first"},
    Trouble{SQLITE_CANTOPEN, "it cannot be opened", "check the path, and the permissions of file and folder"},
    Trouble{SQLITE_PERM, "it cannot be opened", "check the permissions of file and folder"},
    Trouble{SQLITE_READONLY, "it cannot be written", "check the permissions of file and folder"},
    Trouble{SQLITE_TOOBIG, "a value is too large", "give shorter texts"},
    Trouble{SQLITE_NOMEM, "memory has run out", "free some memory and run the command again"}};

const Trouble* troubleOf(int code) {
  for (const Trouble& trouble : kTroubles) {
    if (trouble.code == (code & 0xff)) return &trouble;
  }
  return nullptr;
}

// As SQLite's file URIs have it.
std::string uriOf(const std::filesystem::path& file) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(file).string()) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || std::strchr("/._-", c) != nullptr;
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

// Copies the text.
struct BindValue {
  sqlite3_stmt* statement;
  int place;
  int operator()(std::monostate) const { return sqlite3_bind_null(statement, place); }
  int operator()(std::int64_t x) const { return sqlite3_bind_int64(statement, place, x); }
  int operator()(double x) const { return sqlite3_bind_double(statement, place, x); }
  int operator()(const std::string& x) const {
    return sqlite3_bind_text64(statement, place, x.data(), x.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
  }
};

// Not even a schema with traps gets to run anything.
void distrust(sqlite3* handle) {
  sqlite3_extended_result_codes(handle, 1);
  sqlite3_busy_timeout(handle, kBusyTimeoutMs);
  sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, kMaxValueBytes);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
}

// A callback of sqlite3_exec: appends the row to a text.
int appendRow(void* text, int columns, char** values, char**) {
  for (int i = 0; i < columns; ++i) {
    *static_cast<std::string*>(text) += fmt::format("{}\n", values[i] == nullptr ? "" : values[i]);
  }
  return 0;
}

// All rows as text, one value a line.
int query(sqlite3* handle, const char* sql, std::string& text) {
  return sqlite3_exec(handle, sql, appendRow, &text, nullptr);
}

constexpr const char* kSchema = "SELECT type, name, tbl_name, sql FROM sqlite_schema ORDER BY type, name";

// What SQLite makes of a schema.
std::string schemaText(const char* statements) {
  sqlite3* memory = nullptr;
  std::string text;
  int code = sqlite3_open(":memory:", &memory);
  if (code == SQLITE_OK) code = sqlite3_exec(memory, statements, nullptr, nullptr, nullptr);
  if (code == SQLITE_OK) code = query(memory, kSchema, text);
  sqlite3_close(memory);
  assert(code == SQLITE_OK);
  return text;
}

// The same, made once for all files of a kind.
const std::string& knownSchemaText(const char* statements) {
  static std::mutex mutex;
  static std::map<std::string, std::string> known;  // by statements
  const std::lock_guard lock(mutex);
  std::string& text = known[statements];
  if (text.empty()) text = schemaText(statements);
  return text;
}

// A log with something in it belongs to a writer that is at work, or was killed.
bool hasLog(std::filesystem::path file) {
  std::error_code absent;
  const std::uintmax_t size = std::filesystem::file_size(file += "-wal", absent);
  return !absent && size > 0;
}

}  // namespace

Database::Database(const std::filesystem::path& file, const FileKind& kind, Access access)
    : file_(file), kind_(kind), handle_(nullptr, sqlite3_close) {
  requirePlainFile();
  open(access);
  execute("PRAGMA foreign_keys = ON; PRAGMA synchronous = FULL; PRAGMA cell_size_check = ON");
  const bool fresh = access == Access::write && isNew();
  if (!fresh) requireKind();
  if (access == Access::write) execute("PRAGMA journal_mode = WAL");
  fresh ? create() : requireSound();
}

Database::~Database() = default;

std::string Database::title() const { return fmt::format("{} '{}'", kind_.name, file_.string()); }

void Database::fail(int code) const {
  const std::string message = sqlite3_errmsg(handle_.get());
  const int system = handle_ ? sqlite3_system_errno(handle_.get()) : 0;
  if ((code & 0xff) == SQLITE_CORRUPT) failDamaged(message);
  if ((code & 0xff) == SQLITE_NOTADB) failForeign();
  const std::string detail = system == 0 ? message : fmt::format("{}: {}", message, std::strerror(system));
  const Trouble* trouble = troubleOf(code);
  if (trouble == nullptr) throw StoreError(fmt::format("{}: SQLite's error {} ({})", title(), code, detail));
  throw StoreError(fmt::format("{}: {} ({}); {}", title(), trouble->cause, detail, trouble->remedy));
}

void Database::failDamaged(const std::string& what) const {
  throw StoreError(fmt::format("{} is damaged: {}; {}", title(), what, kind_.remedy));
}

void Database::failForeign() const {
  throw StoreError(fmt::format("'{}' is no {}; give the name of another file", file_.string(), kind_.name));
}

void Database::requirePlainFile() const {
  std::error_code absent;
  const auto type = std::filesystem::status(file_, absent).type();
  if (type != std::filesystem::file_type::not_found && type != std::filesystem::file_type::regular)
    failForeign();
}

int Database::tryOpen(int flags, const char* parameters) {
  sqlite3* handle = nullptr;
  const int code =
      sqlite3_open_v2((uriOf(file_) + parameters).c_str(), &handle, flags | SQLITE_OPEN_URI, nullptr);
  handle_.reset(handle);
  if (code != SQLITE_OK) return code;
  distrust(handle);
  return sqlite3_exec(handle, "SELECT count(*) FROM sqlite_schema", nullptr, nullptr, nullptr);
}

void Database::open(Access access) {
  int code = tryOpen(
      access == Access::write ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY, "");
  const bool no_room_beside = (code & 0xff) == SQLITE_CANTOPEN || (code & 0xff) == SQLITE_READONLY;
  // Readers agree with writers through files beside this one. Where none can be made, as on a read-only file
  // system, there is no writer either.
  if (no_room_beside && access == Access::read && !hasLog(file_))
    code = tryOpen(SQLITE_OPEN_READONLY, "?immutable=1");
  if (code != SQLITE_OK) fail(code);
}

std::string Database::ask(const char* sql) const {
  std::string text;
  if (const int code = query(handle_.get(), sql, text); code != SQLITE_OK) fail(code);
  return text;
}

bool Database::isNew() const {
  return ask("PRAGMA application_id; PRAGMA user_version; SELECT count(*) FROM sqlite_schema") == "0\n0\n0\n";
}

void Database::create() const {
  const Transaction transaction(*this, Transaction::Purpose::write);
  execute(kind_.schema);
  execute(
      fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", kind_.application_id, kind_.version)
          .c_str());
  transaction.commit();
}

void Database::requireKind() const {
  if (ask("PRAGMA application_id") != fmt::format("{}\n", kind_.application_id)) failForeign();
  const std::string version = ask("PRAGMA user_version");
  if (std::stoi(version) > kind_.version) {
    throw StoreError(
        fmt::format("{} was written by a newer Boxgrasp (format {}, known are up to {}); update this one",
                    title(), std::stoi(version), kind_.version));
  }
  if (ask(kSchema) != knownSchemaText(kind_.schema)) failDamaged("its tables are not those of this format");
}

void Database::requireSound() const {
  const std::string findings = ask("PRAGMA quick_check(1)");
  if (findings != "ok\n") failDamaged(findings.substr(0, findings.size() - 1));
}

void Database::execute(const char* sql) const {
  if (const int code = sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr); code != SQLITE_OK)
    fail(code);
}

std::int64_t Database::changedRows() const { return sqlite3_changes64(handle_.get()); }
std::int64_t Database::lastRow() const { return sqlite3_last_insert_rowid(handle_.get()); }
bool Database::inTransaction() const { return sqlite3_get_autocommit(handle_.get()) == 0; }

void Database::rollBack() const noexcept {
  sqlite3_exec(handle_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
}

Statement::Statement(const Database& database, const std::string& sql)
    : database_(database), handle_(nullptr, sqlite3_finalize) {
  sqlite3_stmt* handle = nullptr;
  const int code = sqlite3_prepare_v2(database.handle_.get(), sql.c_str(), -1, &handle, nullptr);
  if (code != SQLITE_OK) database.fail(code);
  handle_.reset(handle);
}

Statement& Statement::bind(const std::vector<Value>& values) {
  sqlite3_reset(handle_.get());
  assert(static_cast<int>(values.size()) == sqlite3_bind_parameter_count(handle_.get()));
  for (int i = 0; i < static_cast<int>(values.size()); ++i) {
    const int code = std::visit(BindValue{handle_.get(), i + 1}, values[i]);
    if (code != SQLITE_OK) database_.fail(code);
  }
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(handle_.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE) database_.fail(code);
  return code == SQLITE_ROW;
}

Value Statement::value(int column) const {
  sqlite3_stmt* row = handle_.get();
  switch (sqlite3_column_type(row, column)) {
    case SQLITE_INTEGER:
      return std::int64_t{sqlite3_column_int64(row, column)};
    case SQLITE_FLOAT:
      return sqlite3_column_double(row, column);
    case SQLITE_TEXT:
      return std::string(reinterpret_cast<const char*>(sqlite3_column_text(row, column)),
                         static_cast<std::size_t>(sqlite3_column_bytes(row, column)));
    case SQLITE_BLOB:
      database_.failDamaged("there are bytes where no column has any");
  }
  return {};
}

std::int64_t Statement::integer(int column) const {
  std::int64_t x = 0;
  read(column, x);
  return x;
}

void Statement::failDamaged(int column, const DecodeError& error) const {
  database_.failDamaged(
      fmt::format("column '{}': {}", sqlite3_column_name(handle_.get(), column), error.what()));
}

Transaction::Transaction(const Database& database, Purpose purpose) : database_(database) {
  database_.execute(purpose == Purpose::write ? "BEGIN IMMEDIATE" : "BEGIN");
}

Transaction::~Transaction() {
  // SQLite itself rolls back after some errors; what else goes wrong here was reported by what failed before.
  if (database_.inTransaction()) database_.rollBack();
}

void Transaction::commit() const { database_.execute("COMMIT"); }

}  // namespace boxgrasp
