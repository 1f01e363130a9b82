// The beats of pauses, counted from the plan of a job.
//
// In:  a job, the part of it that was run, beats by their reasons as the board counts them.
// Out: the same with the reason "pause". Who: job_run.hpp, the estimate.
//
// The board knows a pause only as a target with a number of beats: it counts the last beat as one
// without a point, those before it as motion, and the first of these as protection where the shot
// rate is limited. A beat in a hold is counted as such and is no beat of the pause.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "host/job/job.hpp"

namespace lamplock::run {

/// Name of the reason in reports.
inline constexpr const char* pause_reason = "pause";

using NamedBeats = std::map<std::string, std::uint64_t>;

/// Moves the beats of the pauses among targets `from` up to `end` to their own reason. `inside`:
/// beats from the first shot to the last; `outside`: the others. The sums stay the same.
void count_pauses(const job::Job& job, std::size_t from, std::size_t end, NamedBeats& inside,
                  NamedBeats& outside);

}  // namespace lamplock::run
