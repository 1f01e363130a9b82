// Where a job runs, and what is left of it.
//
// In:  the command line. Out: the board, what is simulated round it, names of files.
// Who: the commands that run something on a board.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/cli/motion_plot_file.hpp"
#include "host/cli/outputs.hpp"
#include "host/gpio/line_table.hpp"
#include "shared/boards/pico_uart.hpp"
#include "shared/settings_table.hpp"
#include "sim/chip/usb_host/usb_function.hpp"
#include "sim/world/drives.hpp"
#include "sim/world/lamp.hpp"

namespace lamplock::cli {

class Command;

/// Faults of a simulated board's lamp.
struct LampFaults {
  double jitter_us = 0, wander_percent = 0, dropouts_percent = 0, runts_percent = 0;
  std::uint64_t seed = 1;

  void add(Command& app);
  bool any() const;
  /// The lamp that belongs to a machine with these settings. Throws Error(bad_input) for a lamp
  /// that cannot be.
  sim::LampConfig lamp(const settings::Values& values) const;
};

/// The drives of a simulated board.
struct SimulatedDrives {
  std::vector<double> lag_us{};  ///< by axis

  void add(Command& app);
  bool any() const { return !lag_us.empty(); }
  /// Those that belong to a machine with these settings.
  sim::DriveConfig drives(const settings::Values& values) const;
};

/// Where a job runs and what is left of it.
struct BoardOptions {
  std::string board = "virtual", image{}, usb = "serial", lines{};
  std::string profile{};  ///< of the machine, which may name lines too; the command fills it in
  std::size_t from = 0;
  unsigned baud = boards::uart_baud;
  std::size_t run_up_lines = 0;  ///< lines from there on that are dark; the command fills it in
  std::uint32_t fired = 0, job_speed = 100;
  bool yes = false, dry = false, json = false, auto_resume = false, discard = false;
  std::string report{}, statistics{}, vcd{}, shots{}, timing{};
  bool resume = false;
  std::string progress{};   ///< journal of the job; empty = beside its input
  std::size_t hold_at = 0;  ///< points; 0 = no hold
  PlotOptions plot{};
  LampFaults faults{};
  SimulatedDrives drives{};

  void add_choice(Command& app);     ///< --board, --image, --usb, --lines
  void add_board(Command& app);      ///< these, --yes, --json
  void add_part(Command& app);       ///< --from, --fired
  void add_resume(Command& app);     ///< --resume, --progress
  void add_job_speed(Command& app);  ///< --job-speed
  /// These, --job-speed, --dry, --hold-at, --report, --statistics, --vcd, --shots,
  /// --timing, --plot and what is simulated
  void add_job(Command& app);
  bool is_simulated() const { return board == "virtual" || board == "chip"; }
  /// Lines of this computer for a real board: those of --lines, else of the profile. Throws
  /// Error(bad_input), also for --lines with a simulated board.
  gpio::LineTable line_table() const;
  /// What a simulated chip is talked to over.
  sim::chip::UsbFunction usb_function() const;
  /// Refuses what the board cannot do, and files that would be written over each other or over
  /// `input`, before any work is done; `save`: where else something is written. Throws
  /// Error(bad_input).
  void check(const std::string& input = "", const std::string& save = "") const;

 private:
  std::vector<Output> outputs() const;
  void check_resume() const;
};

}  // namespace lamplock::cli
