// Reports as aligned tables for the terminal.
//
// In:  one report, or the same job run in two ways. Out: text of several lines, plain ASCII, ready
//      to print. Who: the command line.
#pragma once

#include <string>

#include "host/report/report.hpp"

namespace lamplock::report {

/// Table of one report; unknown values are shown as "unknown".
std::string summary(const Report& report);

/// The same for an estimate: without the values that only a run has.
std::string estimate_summary(const Report& report);

/// Two reports side by side, each headed by its mode, and the ratio of their beats (second to
/// first).
std::string summary(const Report& first, const Report& second);

}  // namespace lamplock::report
