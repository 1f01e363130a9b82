// Where a job or program runs: the board, what is simulated round it, which part runs, files.
//
// In:  values that the command line (host/cli/board_options.hpp) or a server has set. Out: checked
//      choices, configurations of the simulated world.
// Who: the use cases that run something on a board.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/file/output_files.hpp"
#include "host/gpio/line_table.hpp"
#include "host/link/transport.hpp"
#include "host/run/motion_plot_file.hpp"
#include "shared/boards/pico_uart.hpp"
#include "shared/settings_table.hpp"
#include "sim/chip/usb_host/usb_function.hpp"
#include "sim/world/drives.hpp"
#include "sim/world/heat_sensor.hpp"
#include "sim/world/lamp.hpp"

namespace lamplock::run {

/// Faults of a simulated board's lamp.
struct LampFaults {
  double jitter_us = 0, wander_percent = 0, dropouts_percent = 0, runts_percent = 0;
  std::uint64_t seed = 1;

  bool any() const;
  /// The lamp of a machine with these settings. Throws Error(bad_input) for a lamp that cannot
  /// exist.
  sim::LampConfig lamp(const settings::Values& values) const;
};

/// The drives of a simulated board.
struct SimulatedDrives {
  std::vector<double> lag_us{};  ///< by axis

  bool any() const { return !lag_us.empty(); }
  /// The drives of a machine with these settings.
  sim::DriveConfig drives(const settings::Values& values) const;
};

/// A spot that the laser of a simulated board heats, and the sensor at SENSOR that sees it.
struct SimulatedSpot {
  static constexpr std::size_t count = 4;
  /// Rise at full power [K], time constant [s], rise per volt [K/V], volts in the cold. Empty: no
  /// sensor.
  std::vector<double> numbers{};

  bool any() const { return !numbers.empty(); }
  /// Throws Error(bad_input) for numbers without a meaning.
  std::optional<sim::HeatConfig> heat(const settings::Values& values) const;
};

/// Environment variable that names the file of --lines for every command.
inline constexpr const char* lines_variable = "LAMPLOCK_LINES";

struct BoardOptions {
  std::string board = "virtual", image{}, usb = "serial", lines{};
  std::string profile{};  ///< of the machine, which may name lines too; the command fills it in
  std::size_t from = 0;
  unsigned baud = boards::uart_baud;
  std::size_t run_up_lines = 0;  ///< lines from there on that are dark; the use case fills it in
  std::uint32_t fired = 0, job_speed = 100;
  bool yes = false, dry = false, auto_resume = false, discard = false;
  std::string report{}, statistics{}, vcd{}, shots{}, timing{};
  bool resume = false;
  std::string progress{};   ///< journal of the job; empty = beside its input
  std::size_t hold_at = 0;  ///< points; 0 = no hold
  PlotOptions plot{};
  LampFaults faults{};
  SimulatedDrives drives{};
  SimulatedSpot spot{};
  /// Opens the board, in place of its name; for a program that has it open already. Such a board is
  /// a real one for the use cases, also if it is simulated: its time passes as the wall clock's.
  std::function<std::unique_ptr<link::Transport>()> opener{};
  /// The words of the command that runs the job, for its report; empty if there is none.
  std::vector<std::string> command{};

  bool is_simulated() const { return !opener && (board == "virtual" || board == "chip"); }
  /// Lines of this computer for a real board: those of --lines, else of the profile. Throws
  /// Error(bad_input), also for --lines with a simulated board.
  gpio::LineTable line_table() const;
  /// The USB function of a simulated chip that carries the data.
  sim::chip::UsbFunction usb_function() const;
  /// Refuses options that the board cannot fulfil, and files that would replace each other or one
  /// of `inputs`, before any work is done; `save`: another file that is written. Throws
  /// Error(bad_input).
  void check(const std::vector<std::string>& inputs = {}, const std::string& save = "") const;

 private:
  std::vector<Output> outputs() const;
  void check_resume() const;
  void check_timing() const;
  void check_simulated_only() const;
};

}  // namespace lamplock::run
