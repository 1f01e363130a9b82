// Options whose value is empty, as a script gives them whose variable is unset: `--lines "$LINES"`;
// and flags with a value, as in `--dry=no`.
//
// In:  the arguments, and the environment variables of the options. Out: what is wrong. Who: the
//      parser (parser.hpp), before it stores any value.
// An empty value would be the same as an option that is not given, so the option would silently
// have no effect; a flag would be set, or not, by a value that its help does not know.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/cli/command_line.hpp"
#include "host/error.hpp"

namespace lamplock::cli {

/// The refusal of the first empty value, or of the first flag with a value, Error(bad_input);
/// nothing if there is none. An environment variable is not used, and may be empty, if its option
/// is given.
std::optional<Error> wrong_value_use(const Command& program,
                                     const std::vector<std::string>& arguments);

}  // namespace lamplock::cli
