// How the job of a report was made, so that it can be compared and repeated.
//
// In:  the use case that has made or read the job. Out: part of report.json and of the page;
//      job.toml in the folder of the report.
// Who: JobRun and Report.
#pragma once

#include <optional>
#include <string>

namespace lamplock::report {

/// Values of a job file are unknown, except for the command.
struct Making {
  std::string command{};             ///< command line of the run; empty: unknown
  std::string description{};         ///< text of the job description (TOML); empty: unknown
  std::optional<double> spacing_mm;  ///< smallest of the objects; none of point lists
  std::string method{};              ///< methods or kinds of file, separated by commas
  std::string order{};
  std::string material{};  ///< of the glass; empty: none was given
};

/// Name of the job description in the folder of a report.
inline constexpr const char* description_name = "job.toml";

}  // namespace lamplock::report
