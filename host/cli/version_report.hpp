// `lamplock --version --verbose`: what a report of an error should contain.
//
// In:  the program. Out: version, compiler, libraries, protocol and images, as text or JSON.
// Who: program.cpp.
#pragma once

#include "host/cli/command_line.hpp"

namespace lamplock::cli {

/// Adds the options --verbose and --json of --version, and its action.
void add_version_report(Command& program);

}  // namespace lamplock::cli
