// Faults of the program on the chip, for the user and as JSON.
//
// In:  a run that has ended. Out: text, JSON. Who: the summary and the exit status of
// `lamplock chip`.
#pragma once

#include <string>

#include "host/cli/json.hpp"

namespace lamplock::sim::chip {
struct Fault;
}

namespace lamplock::chip_tool {

class ChipRun;

/// "HardFault on core 0, undefined instruction, pc 0x10000200 (die + 0x4), lr ..., cycle ...": one
/// line without an end.
std::string fault_text(const ChipRun& run, const sim::chip::Fault& fault);
/// All faults, in order.
cli::Json faults_json(const ChipRun& run);

}  // namespace lamplock::chip_tool
