// A command line as text.
//
// In:  name and arguments of a program. Out: a line that a shell reads as the same arguments.
// Who: program_main(), for reports that name the command.
#pragma once

#include <string>
#include <vector>

namespace lamplock::cli {

/// Arguments with characters that are special in a POSIX shell are in single quotes.
std::string shell_text(const std::string& program, const std::vector<std::string>& arguments);

}  // namespace lamplock::cli
