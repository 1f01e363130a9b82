#include "firmware/boards/rp2040/storage/restart_record.hpp"

#include "firmware/boards/rp2040/base/watchdog.hpp"
#include "firmware/boards/rp2040/registers/vreg.hpp"
#include "firmware/machine/controller.hpp"

namespace lamplock::rp2040 {
namespace {

constexpr std::uint32_t magic = 0x4c4c5200;  // kind in the lowest byte
constexpr std::uint32_t magic_mask = 0xffffff00;
enum Kind : std::uint32_t { running = 0, faulted = 1 };
/// So that registers of all zeros or all ones are no record.
constexpr std::uint32_t progress_check = 0x5bd1e995;
/// In the check: a shot was handed out.
constexpr std::uint32_t shot_out_mark = 1;

constexpr std::uint32_t check_of(std::uint32_t session, std::uint32_t first_unfired) {
  return session ^ (first_unfired << 16 | first_unfired >> 16) ^ progress_check;
}

Restart reason_of_restart(std::uint32_t mark) {
  const WatchdogRegisters& w = watchdog_registers();
  if ((w.reason & (watchdog_field::reason_timer | watchdog_field::reason_force)) != 0) {
    if ((mark & magic_mask) != magic) return Restart::request;
    return (mark & ~magic_mask) == faulted ? Restart::fault : Restart::watchdog;
  }
  // Several may be set: those of earlier resets are kept until power-off.
  const std::uint32_t chip = vreg_and_chip_reset().chip_reset;
  if ((chip & chip_reset_bit::had_debugger) != 0) return Restart::debugger;
  if ((chip & chip_reset_bit::had_run_pin) != 0) return Restart::run_pin;
  return Restart::power_on;
}

[[gnu::cold]] void add_hex(TextLine& line, std::uint32_t value) {
  line.add(" 0x");
  for (int shift = 28; shift >= 0; shift -= 4) {
    const char digit = "0123456789abcdef"[value >> shift & 0xf];
    line.add({&digit, 1});
  }
}

}  // namespace

LastRun take_last_run() {
  WatchdogRegisters& w = watchdog_registers();
  LastRun run;
  run.reason = reason_of_restart(w.scratch[0]);
  if (run.reason == Restart::fault) run.fault = {w.scratch[1], w.scratch[2], w.scratch[3]};
  const std::uint32_t session = w.scratch[5], first_unfired = w.scratch[6];
  if (run.reason == Restart::fault || run.reason == Restart::watchdog) {
    const std::uint32_t mark = w.scratch[7] ^ check_of(session, first_unfired);
    const bool whole = mark == 0 || mark == shot_out_mark;
    if (whole) {
      run.session = session;
      run.first_unfired = first_unfired;
      run.shot_out = mark == shot_out_mark;
    }
    run.in_job = !whole || session != 0;
  }
  w.scratch[0] = magic | running;
  w.scratch[4] = 0;
  note_progress(0, 0, false);
  return run;
}

void forget_run() { watchdog_registers().scratch[0] = 0; }

void note_progress(std::uint32_t session, std::uint32_t first_unfired, bool shot_out) {
  WatchdogRegisters& w = watchdog_registers();
  w.scratch[5] = session;
  w.scratch[6] = first_unfired;
  w.scratch[7] = check_of(session, first_unfired) ^ (shot_out ? shot_out_mark : 0);
}

void restart_after(const FaultRecord& fault) {
  WatchdogRegisters& w = watchdog_registers();
  w.scratch[1] = fault.pc;
  w.scratch[2] = fault.lr;
  w.scratch[3] = fault.xpsr;
  w.scratch[0] = magic | faulted;
  select_watchdog_reset();
  for (;;) set_bits(w.ctrl, watchdog_field::trigger);
}

void describe(const LastRun& run, TextLine& line) {
  constexpr std::string_view reasons[] = {"power on", "RUN pin", "debugger",
                                          "watchdog", "fault",   "request"};
  line.add("Started by ").add(reasons[static_cast<std::size_t>(run.reason)]);
  if (run.reason == Restart::fault) {
    line.add(", pc");
    add_hex(line, run.fault.pc);
    line.add(" lr");
    add_hex(line, run.fault.lr);
    line.add(" xpsr");
    add_hex(line, run.fault.xpsr);
  }
  if (run.session == 0) return;
  if (run.session == machine::ResumePoint::of_program) {
    line.add(", programs had run");
    return;
  }
  line.add(", job ").add(std::int64_t{run.session});
  line.add(" first point not fired ").add(std::int64_t{run.first_unfired});
  if (run.shot_out) line.add(", which may have been");
}

}  // namespace lamplock::rp2040
