// The temperature of a material below a laser: in depth, along a program, pairs of speed and power,
// settings of a controller.
//
// In:  a material of the library, a laser, a program or a task.
// Out: temperatures, tables, pictures. Nothing is written if anything fails.
// Who: `heat`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/run/frontend.hpp"
#include "host/run/machine_options.hpp"
#include "host/thermal/control_tuning.hpp"
#include "host/thermal/depth_run.hpp"
#include "host/thermal/path_run.hpp"

namespace lamplock::run {

struct HeatOptions {
  std::string material{}, library{}, materials{};  ///< materials: a file of records
  std::string laser{};
  std::optional<double> power_w{}, beam_mm{}, feed_mm_min{}, flux_w_m2{};
  std::string losses = "known";  ///< or none, or names with commas
  double ambient_k = 293.15, convection_w_m2k = 10;
  std::optional<double> thickness_mm{};
  std::string csv{}, picture{};
  bool has_check = true;  ///< of the convergence
  // In depth.
  double time_s = 5, step_s = 0.05;
  std::size_t nodes = 50;
  // Along a program.
  std::string program{};
  MachineOptions machine{};
  std::optional<double> limit_k{};
  // Pairs of speed and power.
  std::string hold{};  ///< "450K", "177C"
  std::vector<double> feeds_mm_min{};
  // Controller.
  thermal::LoopGoal goal{};
  std::optional<double> gain_k{}, time_constant_s{};
  std::optional<double> sensor_k_per_v{}, sensor_volts{};  ///< volts: at the temperature to be held
};

/// What the options say of the material and the laser.
struct HeatCase {
  std::string material{}, thermal_source{};
  thermal::Body body{};
  thermal::Surface surface{};
  thermal::BeamProfile beam{};
  double power_w = 0;
  std::optional<double> laser_w{};            ///< full power of the laser
  std::vector<std::string> omitted_losses{};  ///< "radiation (no emissivity)"
};
/// Throws Error(bad_input) that names a missing constant. A flux needs no laser.
HeatCase heat_case(const HeatOptions& options, bool needs_laser);
/// Lines that say which losses are omitted, how the beam is absorbed.
void say_case(const HeatCase& heat, Frontend& frontend);
/// Shares of the losses in the absorbed energy or power.
void say_losses(const thermal::Losses& losses, double absorbed, Frontend& frontend);
/// Throws Error(job_failed) if more than 1e-9 of the absorbed energy is not accounted for.
void require_balance(const thermal::EnergyBalance& balance);

struct DepthHeat {
  HeatCase heat{};
  thermal::DepthResult result{};
  std::optional<double> refinement{};  ///< change with half the mesh and step
};
DepthHeat heat_in_depth(const HeatOptions& options, Frontend& frontend);

struct HeldHeat {
  HeatCase heat{};
  double hold_k = 0;
  std::vector<thermal::HeldPair> pairs{};
  std::optional<double> refinement{};
};
HeldHeat held_heat(const HeatOptions& options, Frontend& frontend);

struct TunedHeat {
  thermal::Plant plant{};
  thermal::LoopSettings loop{};
  thermal::LoopResponse set_point{}, absorption{};
  thermal::LoopResponse on_board{};        ///< to more absorption, with the delays of a board
  std::vector<std::string> board_lines{};  ///< "$1063=1.235", in the order to be sent
};
TunedHeat tuned_heat(const HeatOptions& options, Frontend& frontend);

struct ProgramHeat {
  HeatCase heat{};
  thermal::PathResult result{};
  std::vector<thermal::LineHeat> lines{};
  std::vector<thermal::Overheated> overheated{};
  double limit_k = 0;
  std::optional<double> max_with_proposal_k{};
  std::optional<double> refinement{};
};
ProgramHeat heat_of_program(const HeatOptions& options, Frontend& frontend);

}  // namespace lamplock::run
