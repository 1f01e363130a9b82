// What a run of an image was like, for people and for programs.
//
// In:  a run that has ended, how long it took. Out: text, JSON. Who: `lamplock chip`.
// Everything but the wall clock's part is the same in every run of the same image and script.
#pragma once

#include <string>

#include "host/chip_tool/chip_run.hpp"
#include "host/cli/json.hpp"

namespace lamplock::chip_tool {

/// Times, cycles, edges, resets, and what was touched and is not modelled.
std::string chip_summary(ChipRun& run, double wall_seconds);
/// Frequencies of the clocks and of the pins.
std::string chip_frequencies(ChipRun& run);
/// All of it.
cli::Json chip_json(ChipRun& run, double wall_seconds);

}  // namespace lamplock::chip_tool
