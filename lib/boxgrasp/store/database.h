// SQLite, as thin as it can be: a file of a known kind, statements, transactions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "boxgrasp/store/store_error.h"
#include "boxgrasp/store/value.h"

struct sqlite3;
struct sqlite3_stmt;

namespace boxgrasp {

// What a file must be to be opened.
struct FileKind {
  const char* name;             // "experience store"
  std::int32_t application_id;  // in SQLite's header, so that no other program's file is taken for ours
  int version;                  // of the schema; a file of a newer one is refused
  const char* schema;           // the statements that make it; a file with any other schema is refused
  const char* remedy;           // for a damaged file
};

// One connection. Write-ahead log; a commit is on the disk (fsync) when it returns. Nothing in the file is
// trusted: a damaged or made-up one gives a StoreError, here or when it is read.
class Database {
 public:
  enum class Access { read, write };

  // Write: creates the file where there is none, or an empty one. Throws StoreError.
  Database(const std::filesystem::path& file, const FileKind& kind, Access access);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void execute(const char* sql) const;
  std::int64_t changedRows() const;  // by the last INSERT, UPDATE or DELETE
  std::int64_t lastRow() const;      // id of the row inserted last
  bool inTransaction() const;
  void rollBack() const noexcept;

  // Throws the StoreError for SQLite's result code, or for what is wrong with the content.
  [[noreturn]] void fail(int code) const;
  [[noreturn]] void failDamaged(const std::string& what) const;
  std::string title() const;  // "experience store 'x.db'", for messages

 private:
  friend class Statement;
  int tryOpen(int flags, const char* parameters);
  void open(Access access);
  std::string ask(const char* sql) const;  // all rows, one value a line
  bool isNew() const;
  [[noreturn]] void failForeign() const;
  void requirePlainFile() const;
  void create() const;
  void requireKind() const;
  void requireSound() const;

  std::filesystem::path file_;
  const FileKind& kind_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> handle_;
};

// A prepared statement. Each place is bound once, in order; run again after bind().
class Statement {
 public:
  Statement(const Database& database, const std::string& sql);
  Statement& bind(const std::vector<Value>& values);
  bool step();  // true: on a row
  Value value(int column) const;

  // Throws StoreError that names the column for a value that is none of this type's.
  template <typename Field>
  void read(int column, Field& field) const;
  std::int64_t integer(int column) const;

 private:
  [[noreturn]] void failDamaged(int column, const DecodeError& error) const;
  const Database& database_;
  std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> handle_;
};

template <typename Field>
void Statement::read(int column, Field& field) const {
  try {
    decode(value(column), field);
  } catch (const DecodeError& error) {
    failDamaged(column, error);
  }
}

// Rolled back unless committed. What is read within sees one state of the file.
class Transaction {
 public:
  enum class Purpose { read, write };
  Transaction(const Database& database, Purpose purpose);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit() const;

 private:
  const Database& database_;
};

}  // namespace boxgrasp
