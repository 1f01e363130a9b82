// Reports as aligned tables for the terminal.
//
// In:  one report, or the same job run in two ways. Out: text of several lines, plain ASCII, ready
//      to print. Who: the command line.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host/report/report.hpp"

namespace lamplock::report {

/// "Stopped at 2 123 of 6 773; continue with: COMMAND": how a job ended before its last point, and
/// that a dry run fired nothing; empty if the job is done, and for an estimate.
std::string headline(const Report& report);

/// Table of one report, below its headline; unknown values are shown as "unknown".
std::string summary(const Report& report);

/// The same without the headline.
std::string table(const Report& report);

/// The same for an estimate: without the values that only a run has.
std::string estimate_summary(const Report& report);

/// Settings whose values differ, in the order of the table.
std::vector<settings::Id> differing_settings(const Report& first, const Report& second);

/// Two reports side by side: their results, the ratio of their beats (second to first), and what
/// differs in how their jobs were made and in their settings. `headings`: of the columns; empty: no
/// line of headings.
std::string summary(const Report& first, const Report& second,
                    const std::array<std::string, 2>& headings = {});

}  // namespace lamplock::report
