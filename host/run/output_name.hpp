// Names of files to write: none may have the ending of another kind of file.
//
// In:  the name of an output and the ending of its kind. Out: nothing, or an Error. Who: the
// command line, for the files that options name; the use cases that write programs.
#pragma once

#include <string>
#include <string_view>

namespace lamplock::run {

/// A model, a job or a library of the user would be replaced, or the file would be read as what it
/// is not. Other endings than those of this program are permitted, and so are devices and pipes.
/// Throws Error(bad_input) unless the name may be that of a file of the kind `ending`, ".csv".
void check_output_name(const std::string& output, std::string_view ending);

}  // namespace lamplock::run
