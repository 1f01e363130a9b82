// Fatal faults of a program for the chip: HardFault, lock-up, a boot block that the ROM refuses, a
// reset by the watchdog.
//
// In:  the state known to a core, the boot ROM or the watchdog at that time.
// Out: a record with cause and place, and its words.
// Who: made by Core and Chip, kept by Chip, shown and judged by `lamplock chip`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "sim/chip/fabric/time_wheel.hpp"

namespace lamplock::sim::chip {

enum class FaultKind : std::uint8_t { hard_fault, lock_up, boot_block, watchdog };

enum class FaultCause : std::uint8_t {
  undefined_instruction,
  unpredictable_instruction,
  breakpoint,       ///< BKPT without a debugger
  supervisor_call,  ///< SVC where its priority is too low
  even_address,     ///< the Thumb bit of a branch or a vector is clear
  unaligned_access,
  failed_read,
  failed_write,
  failed_fetch,
  refused_by_mpu,
  stacking,          ///< the frame of an exception cannot be written
  unstacking,        ///< the frame of an exception cannot be read, or is not one
  vector,            ///< the address of a handler cannot be read
  exception_return,  ///< EXC_RETURN does not fit the active exceptions
  rom_access,        ///< an access of a function of the boot ROM failed
  boot_checksum,
  watchdog_timer,
  watchdog_forced
};

/// One fault.
struct Fault {
  FaultKind kind = FaultKind::hard_fault;
  FaultCause cause = FaultCause::undefined_instruction;
  std::uint32_t address = 0;  ///< accessed, if the cause has one
  int core = 0;
  std::uint32_t pc = 0, lr = 0;  ///< of the instruction at fault; of core 0 for the watchdog
  Cycle cycle = 0;
  Picoseconds at = 0;
};

/// "HardFault", "lock-up", ...
std::string_view title_of(FaultKind kind);
/// The kind's word in scripts and in JSON: "hardfault", "lockup", "bootblock", "watchdog".
std::string_view word_of(FaultKind kind);
/// The kind with this word.
std::optional<FaultKind> fault_kind(std::string_view word);
/// "unaligned access to 0x20000001", ...
std::string cause_text(const Fault& fault);

}  // namespace lamplock::sim::chip
