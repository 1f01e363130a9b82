// The memory access of the next step of a core, before the step runs.
//
// In:  the core in front of an instruction or an exception entry. Out: the bytes that it loads or
//      stores. Who: DebugTarget, for watchpoints; never while none is set.
// Includes instructions that the core itself will refuse (unaligned, no memory there).
// Excludes the words that a return from an exception pops, and accesses of native ROM functions.
#pragma once

#include <cstdint>
#include <optional>

#include "sim/chip/cpu/core.hpp"
#include "sim/chip/fabric/bus.hpp"

namespace lamplock::sim::chip::gdb {

/// Consecutive bytes that one step reads or writes.
struct StepAccess {
  std::uint32_t address = 0;
  std::uint32_t size = 0;
  bool write = false;
};

/// The access of the core's next step, if it has one.
std::optional<StepAccess> next_access(const Core& core, Bus& bus);

/// One address for all aliases of the same place: flash, SRAM and registers (RP2040 datasheet,
/// 2.1.2, 2.6.2, 2.6.3).
std::uint32_t canonical_address(std::uint32_t address);

}  // namespace lamplock::sim::chip::gdb
