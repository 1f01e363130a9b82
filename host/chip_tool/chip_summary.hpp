// What a run of an image was like, for people and for programs.
//
// In:  a run that has ended, and how. Out: text, JSON. Who: `lamplock chip`.
// Everything but the wall clock's part is the same in every run of the same image and script.
#pragma once

#include <string>

#include "host/chip_tool/chip_run.hpp"
#include "host/cli/json.hpp"

namespace lamplock::chip_tool {

/// Times, why the run ended, cycles, edges, faults, resets, and what was touched and is not
/// modelled.
std::string chip_summary(ChipRun& run, const RunResult& result);
/// Why the run ended: "--until 5 ms reached", ...
std::string end_text(const RunResult& result);
/// What the script was waiting for when a run ended before it.
sim::chip::script::Failure open_step(const ChipRun& run, const RunResult& result);
/// Frequencies of the clocks and of the pins.
std::string chip_frequencies(ChipRun& run);
/// All of it.
cli::Json chip_json(ChipRun& run, const RunResult& result);

}  // namespace lamplock::chip_tool
