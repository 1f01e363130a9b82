// The command as the user has typed it, for reports and advice.
//
// In:  the arguments of main. Out: words. Who: program_main() stores them, commands that run jobs
// read them.
#pragma once

#include <string>
#include <vector>

namespace lamplock::cli {

/// Stores the words, once, before a command runs.
void set_typed_command(std::vector<std::string> words);

/// The words, the name of the program first.
const std::vector<std::string>& typed_command();

}  // namespace lamplock::cli
