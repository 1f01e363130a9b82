// A report folder that is whole or not there, and reports read back from it.
//
// In:  a judged run, or a folder. Out: the folder, or the report. Who: engrave, send, compare.
#pragma once

#include <filesystem>
#include <vector>

#include "host/report/report.hpp"

namespace lamplock::run {

/// The files of a report in a folder; none of no folder ("").
std::vector<std::filesystem::path> files_of_report(const std::filesystem::path& folder);

/// Throws Error(bad_input) if no report can be written there, before there is one.
void check_report_folder(const std::filesystem::path& folder);

/// Writes the files of a report; files of an older report in the folder go. Throws
/// Error(bad_input).
void write_report_whole(const report::Report& report, const report::JobRun& run,
                        const std::filesystem::path& folder);

/// Reads report.json of a folder. Throws Error(bad_input) if it is not there or not ours.
report::Report read_report(const std::filesystem::path& folder);

}  // namespace lamplock::run
