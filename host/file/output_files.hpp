// The files that a command is to write, looked at together before any work.
//
// In:  options and their files, the files that the command reads. Out: nothing, or an Error.
// Who: the command line, for the files that options name; the use cases that read further files,
//      which a job description names.
#pragma once

#include <string>
#include <vector>

namespace lamplock {

/// An option and the file that it writes; empty: none.
struct Output {
  std::string option, file;
};

/// Of two outputs in one file the later one would be all that is left, and an output in place of
/// an input would replace it. Names are compared by the files that they lead to: `./a`, links and
/// capitals count. Throws Error(bad_input).
void check_distinct(const std::vector<Output>& outputs,
                    const std::vector<std::string>& inputs = {});

/// Whether a name leads to the file or pipe that the standard output of this process is.
bool is_standard_output(const std::string& file);

}  // namespace lamplock
