// The statistics file of a workshop, with a line for every job.
//
// In:  the report of a job, how it ended, when. Out: a line of CSV (RFC 4180) at the end of a file,
//      and a line of names before the first one. Who: the commands that run jobs.
//
// New versions add columns at the end only: a file begun by an older version keeps its line of
// names and its columns. In a newer version's file unknown columns stay empty. Any other file is
// refused.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "host/report/report.hpp"

namespace lamplock::report {

/// "2026-03-28T09:30:00Z": ISO 8601, universal time.
std::string date_text(std::chrono::system_clock::time_point when);

/// The line of names, with its end of line.
std::string statistics_names();

/// Throws lamplock::Error (bad_input) if the file exists and is not a statistics file, or if it
/// cannot be written.
void check_statistics(const std::filesystem::path& file);

/// Appends a job to the file, which is created if necessary. Throws lamplock::Error if it cannot be
/// written, or as check_statistics().
void append_statistics(const std::filesystem::path& file, const Report& report,
                       const std::string& end, std::chrono::system_clock::time_point when);

}  // namespace lamplock::report
