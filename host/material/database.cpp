#include "host/material/database.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include "host/error.hpp"
#include "host/file.hpp"

namespace lamplock::material {
namespace {

/// Longer than any command writes; other processes write for some milliseconds.
constexpr int busy_timeout_ms = 20'000;

struct Finalize {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, Finalize>;

/// Binds the value of a place, from 1; returns SQLite's code.
struct Binder {
  sqlite3_stmt* statement;
  int place;

  int operator()(std::monostate /*null*/) const { return sqlite3_bind_null(statement, place); }
  int operator()(std::int64_t value) const { return sqlite3_bind_int64(statement, place, value); }
  int operator()(double value) const { return sqlite3_bind_double(statement, place, value); }
  int operator()(const std::string& text) const {
    return sqlite3_bind_text64(statement, place, text.data(), text.size(), SQLITE_TRANSIENT,
                               SQLITE_UTF8);
  }
};

SqlValue value_of(sqlite3_stmt* statement, int column) {
  switch (sqlite3_column_type(statement, column)) {
    case SQLITE_NULL:
      return {};
    case SQLITE_INTEGER:
      return static_cast<std::int64_t>(sqlite3_column_int64(statement, column));
    case SQLITE_FLOAT:
      return sqlite3_column_double(statement, column);
    default: {
      const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
      const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement, column));
      return text == nullptr ? std::string() : std::string(text, size);
    }
  }
}

SqlRow row_of(sqlite3_stmt* statement) {
  SqlRow row;
  const int columns = sqlite3_column_count(statement);
  for (int column = 0; column < columns; ++column) row.push_back(value_of(statement, column));
  return row;
}

}  // namespace

void Database::Close::operator()(sqlite3* database) const { sqlite3_close_v2(database); }

Database::Database(std::filesystem::path file) : file_(std::move(file)) {
  std::error_code failure;
  if (std::filesystem::exists(file_, failure) && !std::filesystem::is_regular_file(file_, failure))
    refuse(file_, "not a file", "give a file for the library, not a folder or device");
  sqlite3* opened = nullptr;
  const int code = sqlite3_open_v2(file_.empty() ? ":memory:" : file_.c_str(), &opened,
                                   SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  database_.reset(opened);
  if (code != SQLITE_OK) fail(code);
  sqlite3_extended_result_codes(opened, 1);
  sqlite3_busy_timeout(opened, busy_timeout_ms);
  // After a power failure too, a committed record is there.
  execute("PRAGMA foreign_keys = ON; PRAGMA synchronous = FULL");
}

Database::~Database() = default;

void Database::fail(int code) const {
  constexpr int primary_code = 0xff;
  switch (code & primary_code) {
    case SQLITE_NOTADB:
      refuse(file_, "it is not a material library", "give the file of a library, or a new name");
    case SQLITE_CORRUPT:
      refuse(file_, "the library is damaged", "restore a copy of it, or import an exported file");
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      refuse(file_, "another program uses the library for a long time", "try again");
    case SQLITE_CANTOPEN:
      refuse(file_, "the library cannot be opened", "check its folder and the permissions");
    case SQLITE_READONLY:
    case SQLITE_PERM:
      refuse(file_, "the library cannot be written (read only)",
             "check the permissions of the file and of its folder");
    case SQLITE_FULL:
      refuse(file_, "the library cannot be written (No space left on device)", "free some space");
    case SQLITE_IOERR:
      refuse(file_, "the library cannot be read or written (input/output error)",
             "check its disk, and the space on it");
    default:
      refuse(file_,
             fmt::format("the library refuses this ({})",
                         database_ ? sqlite3_errmsg(database_.get()) : sqlite3_errstr(code)),
             "give another record, or another library");
  }
}

void Database::execute(const std::string& statements) {
  const int code = sqlite3_exec(database_.get(), statements.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code);
}

std::vector<SqlRow> Database::query(const std::string& statement,
                                    const std::vector<SqlValue>& values) {
  sqlite3_stmt* made = nullptr;
  if (const int code = sqlite3_prepare_v2(database_.get(), statement.c_str(), -1, &made, nullptr);
      code != SQLITE_OK)
    fail(code);
  const Statement prepared(made);
  int place = 0;
  for (const SqlValue& value : values)
    if (const int code = std::visit(Binder{made, ++place}, value); code != SQLITE_OK) fail(code);
  std::vector<SqlRow> rows;
  int code = sqlite3_step(made);
  for (; code == SQLITE_ROW; code = sqlite3_step(made)) rows.push_back(row_of(made));
  if (code != SQLITE_DONE) fail(code);
  return rows;
}

std::int64_t Database::number(const std::string& statement) {
  const std::vector<SqlRow> rows = query(statement);
  if (rows.size() == 1 && rows[0].size() == 1)
    if (const auto* value = std::get_if<std::int64_t>(&rows[0][0])) return *value;
  return 0;
}

std::int64_t Database::last_row() const { return sqlite3_last_insert_rowid(database_.get()); }

Transaction::Transaction(Database& database, Kind kind) : database_(database) {
  database_.execute(kind == Kind::writes ? "BEGIN IMMEDIATE" : "BEGIN");
}

Transaction::~Transaction() {
  if (!is_open_) return;
  try {
    database_.execute("ROLLBACK");
  } catch (const Error&) {  // NOLINT(bugprone-empty-catch): SQLite has undone it already
  }
}

void Transaction::commit() {
  database_.execute("COMMIT");
  is_open_ = false;
}

}  // namespace lamplock::material
