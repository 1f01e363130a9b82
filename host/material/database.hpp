// A database in one file (SQLite), with errors for the user.
//
// In:  a file, statements of SQL. Out: rows; an Error that says what to do.
// Who: the material library.
//
// Several processes may use one file. A transaction is written whole or not at all, also when the
// process is killed in the middle of it: the next process that opens the file completes or undoes
// it (https://www.sqlite.org/atomiccommit.html).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <variant>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace lamplock::material {

/// A value of a row; monostate is SQL's NULL.
using SqlValue = std::variant<std::monostate, std::int64_t, double, std::string>;
using SqlRow = std::vector<SqlValue>;

class Database {
 public:
  /// Opens the file or makes an empty one; without a name, a database in memory. Throws
  /// Error(bad_input).
  explicit Database(std::filesystem::path file);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// Runs statements without values and rows.
  void execute(const std::string& statements);
  /// Runs one statement with values in place of its question marks; returns its rows.
  std::vector<SqlRow> query(const std::string& statement, const std::vector<SqlValue>& values = {});
  /// A number of one row and column.
  std::int64_t number(const std::string& statement);
  /// The row number of the last insertion.
  std::int64_t last_row() const;

  const std::filesystem::path& file() const { return file_; }

 private:
  [[noreturn]] void fail(int code) const;

  std::filesystem::path file_;
  struct Close {
    void operator()(sqlite3* database) const;
  };
  std::unique_ptr<sqlite3, Close> database_;
};

/// Sees the database as it is at one moment; one that writes excludes other writers from its
/// beginning to its end. Without commit() its changes are undone.
class Transaction {
 public:
  enum class Kind : std::uint8_t { reads, writes };
  explicit Transaction(Database& database, Kind kind = Kind::writes);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  Database& database_;
  bool is_open_ = true;
};

}  // namespace lamplock::material
