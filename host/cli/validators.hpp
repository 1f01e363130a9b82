// What options of the command line accept.
//
// In:  the text of a value. Out: nothing, or what is wrong with it. Who: options of commands.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "host/glass/parameters.hpp"

namespace lamplock::cli {

/// Accepts the finite numbers of a range.
CLI::Validator number_in(const glass::Range& range);

/// Accepts finite numbers greater than `low`, or from `low` on.
CLI::Validator number_from(double low, bool included);

/// Accepts all names of files but the empty one.
CLI::Validator file_name();

/// Accepts one of these names.
CLI::Validator one_of(std::vector<std::string> names);

}  // namespace lamplock::cli
