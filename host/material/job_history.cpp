#include "host/material/job_history.hpp"

#include <fmt/format.h>

#include <utility>

#include "host/error.hpp"
#include "host/material/database.hpp"
#include "host/material/library.hpp"

namespace lamplock::material {
namespace {

namespace fs = std::filesystem;

constexpr const char* columns =
    "file, board, begin_utc, end_utc, result, message, item, dry, done, total, wasted_beats, "
    "report";

/// Damaged files, and those that another program changed, have values of other kinds.
template <class Value>
const Value& value_of(const SqlValue& sql) {
  if (const auto* value = std::get_if<Value>(&sql)) return *value;
  throw Error(Exit::bad_input, "history of jobs", "a record has a value of the wrong kind",
              "restore a copy of the library, or name another one");
}

JobRecord record_of(const SqlRow& row) {
  JobRecord job;
  std::size_t column = 0;
  for (std::string* text :
       {&job.file, &job.board, &job.begin, &job.end, &job.result, &job.message, &job.item})
    *text = value_of<std::string>(row[column++]);
  job.is_dry = value_of<std::int64_t>(row[column++]) != 0;
  job.done = value_of<std::int64_t>(row[column++]);
  job.total = value_of<std::int64_t>(row[column++]);
  if (!std::holds_alternative<std::monostate>(row[column]))
    job.wasted_beats = value_of<std::int64_t>(row[column]);
  job.report = value_of<std::string>(row[column + 1]);
  return job;
}

}  // namespace

void add_job(const fs::path& library, const JobRecord& job) {
  { const Library made_or_migrated(library); }
  Database database(library);
  Transaction transaction(database);
  database.query(
      fmt::format("INSERT INTO job ({}) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)", columns),
      {job.file, job.board, job.begin, job.end, job.result, job.message, job.item,
       std::int64_t{job.is_dry ? 1 : 0}, job.done, job.total,
       job.wasted_beats ? SqlValue(*job.wasted_beats) : SqlValue(), job.report});
  database.execute(fmt::format("DELETE FROM job WHERE number <= (SELECT max(number) FROM job) - {}",
                               max_job_records));
  transaction.commit();
}

std::vector<JobRecord> last_jobs(const fs::path& library, std::size_t count) {
  std::error_code ignored;
  if (!fs::exists(library, ignored)) return {};
  { const Library migrated(library); }
  Database database(library);
  std::vector<JobRecord> jobs;
  for (const SqlRow& row :
       database.query(fmt::format("SELECT {} FROM job ORDER BY number DESC LIMIT ?", columns),
                      {static_cast<std::int64_t>(count)}))
    jobs.push_back(record_of(row));
  return jobs;
}

}  // namespace lamplock::material
