// What options of the command line accept.
//
// In:  the text of a value. Out: nothing, or what is wrong with it. Who: options of commands.
#pragma once

#include <string>
#include <vector>

#include "host/cli/command_line.hpp"
#include "host/glass/parameters.hpp"

namespace lamplock::cli {

/// Accepts the finite numbers of a range.
Check number_in(const glass::Range& range);

/// Accepts finite numbers greater than `low`, or from `low` on.
Check number_from(double low, bool included);

/// Accepts one of these names.
Check one_of(std::vector<std::string> names);

}  // namespace lamplock::cli
