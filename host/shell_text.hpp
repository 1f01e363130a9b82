// A command line as text.
//
// In:  words of a command. Out: a line that a shell reads as the same words.
// Who: reports that name their command, advice that continues a job.
#pragma once

#include <string>
#include <vector>

namespace lamplock {

/// Words with characters that are special in a POSIX shell are in single quotes.
std::string shell_text(const std::vector<std::string>& words);

}  // namespace lamplock
