// A change of the overrides while lines run.
//
// In:  the user, or a report of the board. Out: the orders of a planned run (line_run.hpp).
// Who: programs of G-code (program_run.hpp), jobs of rows, the time that is left (host/run).
#pragma once

#include <cstdint>

namespace lamplock::program_run {

/// Overrides from a time after the begin of a run on; holds and pauses are not counted.
struct SpeedChange {
  double at_s = 0;
  std::uint32_t feed_percent = 100, rapid_percent = 100;
};

}  // namespace lamplock::program_run
