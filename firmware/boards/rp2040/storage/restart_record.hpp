// The record of the last run: why it ended, where it crashed, the progress of the job.
//
// In:  progress from the main loop and the beat interrupt; a fault from its handler.
// Out: after a restart, the reason and the record, as text for the user.
//
// The record is in the scratch registers of the watchdog, which a watchdog reset does not change.
// It is always up to date, because a hung CPU cannot write it at the end.
//
//   0  magic, kind of end      4  unused: the ROM interprets 0xb007c0d3 as a command
//   1  pc                      5  session of the job, 0 = none
//   2  lr                      6  first point not fired
//   3  xpsr                    7  check of 5 and 6, and whether a shot was out
#pragma once

#include <cstdint>

#include "shared/text_line.hpp"

namespace lamplock::rp2040 {

/// Why this run began.
enum class Restart : std::uint8_t {
  power_on,  ///< or a brown-out
  run_pin,
  debugger,
  watchdog,  ///< a signature was missing
  fault,
  request,  ///< by the boot loader, or by this firmware
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
  /// A job may have been in progress: the position of the axes is unknown.
  bool in_job = false;
  /// 0 = no job, or not known; ResumePoint::of_program = no job, but programs have moved the
  /// machine.
  std::uint32_t session = 0;
  std::uint32_t first_unfired = 0;
  /// A shot at that point was handed out: the hardware may have fired it after the end.
  bool shot_out = false;
};

/// Reads the record and begins a new one. Once, before the watchdog starts.
[[gnu::cold]] LastRun take_last_run();

/// The boot loader was requested: the next run must not report a crash.
void forget_run();

/// Progress of the job; session 0 = no job. Any level, one level at a time.
void note_progress(std::uint32_t session, std::uint32_t first_unfired, bool shot_out);

/// Records the registers of a fault and restarts the chip.
[[noreturn]] void restart_after(const FaultRecord& fault);

/// Writes the last run as text, without brackets and line end.
[[gnu::cold]] void describe(const LastRun& run, TextLine& line);

}  // namespace lamplock::rp2040
