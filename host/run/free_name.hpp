// A name that no file has, for the outputs of the rest of a job.
//
// In:  the name that an earlier part of the job has used. Out: that name with a number.
// Who: the command that continues a job, the refusal of a report folder that is in use.
#pragma once

#include <string>

namespace lamplock::run {

/// "report" -> "report-2", "report-2" -> "report-3", "shots.csv" -> "shots-2.csv": the first such
/// name, counted from that number, that nothing on the disk has.
std::string next_free_name(const std::string& name);

/// The same for a folder: a dot in its name begins no extension, and "/" at its end is left out.
std::string next_free_folder(const std::string& name);

}  // namespace lamplock::run
