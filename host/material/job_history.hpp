// The history of jobs: a table of the material library, so that a user has one database.
//
// In:  jobs that have ended. Out: the last ones. Who: the server of the page.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lamplock::material {

/// A job or a program that has ended.
struct JobRecord {
  std::string file, board;
  std::string begin, end;       ///< UTC, "2026-11-28T09:30:00Z"
  std::string result, message;  ///< "done", "stopped", "failed"; why
  std::string item;             ///< "point", "line"
  bool is_dry = false;
  std::int64_t done = 0, total = 0;  ///< items
  /// Of a job of points: lamp flashes without a shot between the first shot and the last.
  std::optional<std::int64_t> wasted_beats{};
  std::string report{};  ///< name of its report; empty: none
  friend bool operator==(const JobRecord&, const JobRecord&) = default;
};

/// So many are kept.
inline constexpr std::size_t max_job_records = 1000;

/// Stores a job and removes those that are too old. Makes the library if there is none. Throws
/// Error(bad_input).
void add_job(const std::filesystem::path& library, const JobRecord& job);

/// The last jobs, newest first; none without a library. Throws Error(bad_input).
std::vector<JobRecord> last_jobs(const std::filesystem::path& library, std::size_t count);

}  // namespace lamplock::material
