// The command that continues a job which has ended early.
//
// In:  the words of the command that ran the job, where the job continues. Out: text to paste
//      into a shell. Who: reports.
#pragma once

#include <string>
#include <vector>

#include "host/link/continuation.hpp"

namespace lamplock::run {

/// The command without the options that say where it begins and without the permission to fire,
/// with new names for the report and the files that the run has written, then the options that
/// continue; empty without words. `is_kept`: the journal has the progress of the job.
std::string continue_command(const std::vector<std::string>& words, const link::Continuation& rest,
                             bool is_kept);

}  // namespace lamplock::run
