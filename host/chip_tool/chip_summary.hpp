// Summary of a run of an image, for the user and as JSON.
//
// In:  a run that has ended, and its result. Out: text, JSON. Who: `lamplock chip`.
// All values but those of the wall clock are the same in every run of the same image and script.
#pragma once

#include <string>

#include "host/cli/json.hpp"

namespace lamplock::sim::chip::script {
struct Failure;
}

namespace lamplock::chip_tool {

class ChipRun;
struct RunResult;

/// Times, reason of the end, cycles, edges, faults, resets, and accesses that are not modelled.
std::string chip_summary(ChipRun& run, const RunResult& result);
/// Why the run ended: "--until 5 ms reached", ...
std::string end_text(const RunResult& result);
/// The unfinished step of the script when a run ended before it.
sim::chip::script::Failure open_step(const ChipRun& run, const RunResult& result);
/// Frequencies of the clocks and of the pins.
std::string chip_frequencies(ChipRun& run);
/// The whole summary as JSON.
cli::Json chip_json(ChipRun& run, const RunResult& result);

}  // namespace lamplock::chip_tool
