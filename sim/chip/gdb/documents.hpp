// The two XML documents about the chip that a debugger reads (manual "Debugging with GDB",
// appendices G and E.18): its registers and its memory map.
#pragma once

#include <cstdint>
#include <string>

namespace lamplock::sim::chip::gdb {

/// Registers of DebugTarget, numbered as there: r0-r12, sp, lr, pc, xpsr, then msp, psp, primask,
/// control.
std::string target_description();

/// Accessible regions, and those where breakpoints cannot be written into memory.
std::string memory_map(std::uint32_t flash_size);

}  // namespace lamplock::sim::chip::gdb
