// Runs a program with points on the beat (M130) on the virtual board.
//
// In:  its text, the settings of the machine and its lamp, which has no faults and is in lock.
// Out: shots, and the time from the first step to the last step or shot: the machine waits for
//      beats, shutters and the attenuator, which only the complete board simulates.
// Who: run_program(). Some hundred times faster than the machine.
#pragma once

#include <cstddef>
#include <string_view>

#include "shared/settings_table.hpp"

namespace lamplock::program_run {

struct LockedRun {
  std::size_t shots = 0;
  double seconds = 0;
};

/// Runs a program without errors to its end; pauses take no time. Throws Error if it does not end.
LockedRun run_locked(std::string_view text, const settings::Values& values);

}  // namespace lamplock::program_run
