// Options of a run beside --save.
//
// In:  the file of the description, an option. Out: nothing, or an Error. Who: the use cases that
// save a description: engrave, job, cut.
#pragma once

#include <string>

namespace lamplock::run {

/// Throws Error(bad_input) if a description will be saved to `save` and an option is given that is
/// no part of it: a rerun of the description would fire what its user does not expect.
void refuse_unsaved(const std::string& save, bool is_given, const char* option);

}  // namespace lamplock::run
