// The files that a command is to write, looked at together before any work.
//
// In:  options and their files. Out: nothing, or an Error. Who: commands with several outputs.
#pragma once

#include <string>
#include <vector>

namespace lamplock {

/// An option and the file that it writes; empty: none.
struct Output {
  std::string option, file;
};

/// Of two outputs in one file the later one would be all that is left, and an output in place of
/// `input` (if there is one) would leave no input. Throws Error(bad_input).
void check_distinct(const std::vector<Output>& outputs, const std::string& input = "");

}  // namespace lamplock
