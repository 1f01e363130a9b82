// Empty values of options, as a script gives them whose variable is unset: `--lines "$LINES"`.
//
// In:  the arguments, and the environment variables of the options. Out: what is wrong. Who: the
//      parser (parser.hpp), before it stores any value.
// An empty value would be the same as an option that is not given, so the option would silently
// have no effect.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/cli/command_line.hpp"
#include "host/error.hpp"

namespace lamplock::cli {

/// The refusal of the first empty value, Error(bad_input); nothing if no value is empty. An
/// environment variable is not used, and may be empty, if its option is given.
std::optional<Error> empty_value(const Command& program, const std::vector<std::string>& arguments);

}  // namespace lamplock::cli
