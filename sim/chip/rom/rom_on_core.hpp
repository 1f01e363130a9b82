// Connects the boot ROM to a core: its traps become the core's native addresses.
//
// In:  calls of the core at the traps. Out: registers, cycles, where to continue.
#pragma once

#include <cstdint>

#include "sim/chip/cpu/core.hpp"
#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/rom/boot_rom.hpp"

namespace lamplock::sim::chip {

/// Registers the ROM's traps with a core, once; all three must live as long as the core runs.
void attach_rom(BootRom& rom, Core& core, Bus& bus);

}  // namespace lamplock::sim::chip
