// What the next run knows of this one: why it ended, where it crashed, how far the job was.
//
// In:  progress from the main loop and the beat interrupt; a fault from its handler.
// Out: after a restart, the reason and the record, as text for the user.
//
// The record lives in the scratch registers of the watchdog, which a watchdog reset leaves alone.
// It is kept up to date all the time, because a hung CPU has no chance to write it at the end.
//
//   0  magic, kind of end      4  unused: the ROM would take 0xb007c0d3 for an order
//   1  pc                      5  session of the job, 0 = none
//   2  lr                      6  first point not fired
//   3  xpsr                    7  check of 5 and 6, and whether a shot was out
#pragma once

#include <cstdint>

#include "firmware/machine/text.hpp"

namespace lamplock::rp2040 {

/// Why this run began.
enum class Restart : std::uint8_t {
  power_on,  ///< or the supply has sagged
  run_pin,
  debugger,
  watchdog,  ///< somebody did not sign
  fault,
  request,  ///< the boot loader, or ourselves on purpose
};

/// Registers that a fault has saved on the stack.
struct FaultRecord {
  std::uint32_t pc = 0, lr = 0;
  std::uint32_t xpsr = 0;  ///< exception number in the lower 9 bits: that of the code that failed
};

/// The end of the last run.
struct LastRun {
  Restart reason = Restart::power_on;
  FaultRecord fault;  ///< reason fault only
  /// A job may have been under way: nobody knows where the axes stand.
  bool in_job = false;
  /// 0 = no job, or nothing is known of it; JobMark::of_program = none, but programs have moved the
  /// machine.
  std::uint32_t session = 0;
  std::uint32_t first_unfired = 0;
  /// A shot at that point was given out: the hardware may have fired it after the end.
  bool shot_out = false;
};

/// Reads the record and begins a new one. Once, before the watchdog starts.
[[gnu::cold]] LastRun take_last_run();

/// The boot loader is wanted: the next run shall not take this one for crashed.
void forget_run();

/// How far the job is; session 0 = no job. Any level, one level at a time.
void note_progress(std::uint32_t session, std::uint32_t first_unfired, bool shot_out);

/// Keeps the registers of a fault and restarts the chip.
[[noreturn]] void restart_after(const FaultRecord& fault);

/// The last run in words, without brackets and line end.
[[gnu::cold]] void describe(const LastRun& run, machine::TextLine& line);

}  // namespace lamplock::rp2040
