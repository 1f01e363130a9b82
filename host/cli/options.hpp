// Options that several commands share, each group with what it means.
//
// In:  the command line, through CLI11. Out: profiles, configurations, names of files.
// Who: the commands.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/motion/target.hpp"
#include "host/cli/motion_plot_file.hpp"
#include "host/job/profile.hpp"
#include "host/model/input.hpp"
#include "host/order/order.hpp"
#include "sim/world/drives.hpp"
#include "sim/world/lamp.hpp"

namespace lamplock::cli {

/// Accepts finite numbers greater than `low`, or from `low` on.
CLI::Validator number_from(double low, bool included);

/// Accepts all names of files but the empty one.
CLI::Validator file_name();

/// Accepts one of these names.
CLI::Validator one_of(std::vector<std::string> names);

/// Which machine, and what is to be different for this job.
struct MachineOptions {
  std::string machine{};
  std::optional<double> lamp_hz{}, accel_m_s2{}, speed_m_s{};
  std::optional<std::string> lamp_mode{};

  void add_machine(CLI::App& app);    ///< --machine alone
  void add_overrides(CLI::App& app);  ///< lamp, acceleration, speed

  /// Profile with the overrides. Throws Error(bad_input).
  job::Profile profile() const;
};

/// How meshes and bitmaps become points. Lengths in mm.
struct PointsOptions {
  std::string method = "slice", direction = "z", up = "z";
  double spacing_mm = 0.1;
  std::optional<double> layer_mm{}, size_mm{}, weld_mm{};
  int threshold = 128, layers = 1;
  bool invert = false;

  void add(CLI::App& app);
  double layer() const { return layer_mm.value_or(spacing_mm); }
  /// Arc lengths are `spacing`, chords a little less: a weld at the spacing itself would thin out
  /// every bend.
  double weld() const { return weld_mm.value_or(0.9 * spacing_mm); }
};

/// In which order points are fired.
struct OrderOption {
  std::optional<std::string> name{};

  void add(CLI::App& app);
  /// Point lists as given, everything else by layers, unless the user says.
  order::Ordering ordering(model::InputKind kind) const;
};

/// How points are joined.
struct ModeOption {
  std::string name = "free";

  void add(CLI::App& app);
  motion::JoinMode mode() const;
};
/// The name of a mode as users write it.
std::string mode_name(std::uint8_t mode);

/// Faults of a simulated board's lamp.
struct LampFaults {
  double jitter_us = 0, wander_percent = 0, dropouts_percent = 0, runts_percent = 0;
  std::uint64_t seed = 1;

  void add(CLI::App& app);
  bool any() const;
  /// The lamp that belongs to a machine with these settings. Throws Error(bad_input) for a lamp
  /// that cannot be.
  sim::LampConfig lamp(const settings::Values& values) const;
};

/// The drives of a simulated board.
struct SimulatedDrives {
  std::vector<double> lag_us{};  ///< by axis

  void add(CLI::App& app);
  bool any() const { return !lag_us.empty(); }
  /// Those that belong to a machine with these settings.
  sim::DriveConfig drives(const settings::Values& values) const;
};

/// Where a job runs and what is left of it.
struct BoardOptions {
  std::string board = "virtual", image{};
  std::size_t from = 0;
  std::uint32_t fired = 0, job_speed = 100;
  bool yes = false, dry = false, json = false;
  std::string report{}, vcd{}, shots{}, timing{};
  std::size_t hold_at = 0;  ///< points; 0 = no hold
  PlotOptions plot{};
  LampFaults faults{};
  SimulatedDrives drives{};

  void add_choice(CLI::App& app);     ///< --board, --image
  void add_board(CLI::App& app);      ///< these, --yes, --json
  void add_job_speed(CLI::App& app);  ///< --job-speed
  /// --from, --fired, --job-speed, --dry, --hold-at, --report, --vcd, --shots, --timing, --plot and
  /// what is simulated
  void add_job(CLI::App& app);
  bool is_simulated() const { return board == "virtual" || board == "chip"; }
  /// Refuses what the board cannot do, before any work is done. Throws Error(bad_input).
  void check() const;
};

}  // namespace lamplock::cli
