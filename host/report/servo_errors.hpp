// How far servo drives were from what a program asked of them: the table of a diagnostics run.
//
// In:  a sampled run (program/servo_run.hpp). Out: per axis the largest errors of either sign and
//      their root mean square, programmed less measured, at the same time; the same of the pulses
//      alone, in pulses; how far the load was beside the path, whenever it came there; ends.
// Who: `lamplock diagnose`; tests.
//
// An error along the path is a load that follows late: it costs nothing where both axes are late
// alike. What is left of a workpiece is the distance beside the path.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host/program/servo_run.hpp"

namespace lamplock::report {

struct ServoAxisErrors {
  double most_mm = 0, least_mm = 0;  ///< largest positive and negative error
  double rms_mm = 0;
  double most_pulses = 0;  ///< between the program, as the controller counts it, and the pulses
  double programmed_end_mm = 0, measured_end_mm = 0;
  long end_pulses = 0;
};

struct ServoErrors {
  std::string name;  ///< of the trajectory
  std::array<ServoAxisErrors, program_run::servo_axes> axis{};
  double beside_mm = 0;  ///< furthest from the path
  double moving_s = 0;
  std::size_t samples = 0;
};

/// `pulses_per_mm`: of the drives; run.steps_per_mm is what the controller takes it for. The run
/// has samples.
ServoErrors servo_errors(const program_run::ServoRun& run, double pulses_per_mm,
                         const std::string& name);

/// How far a sample's load is from the path near it, mm.
double beside_path_mm(const program_run::ServoRun& run, std::size_t sample);

/// The table as text, lines with their ends.
std::string servo_table(const std::vector<ServoErrors>& rows);

}  // namespace lamplock::report
