// Errors of servo drives against the program: the table of a diagnostics run.
//
// In:  a sampled run (program/servo_run.hpp). Out: per axis the largest errors of either sign and
//      their root mean square, programmed less measured, at the same time; the same for the pulses
//      alone, in pulses; the distance of the load from the path at any time; ends.
// Who: `lamplock diagnose`; tests.
//
// An error along the path is a following error in time: it does no harm if both axes have the same
// lag. The workpiece shows only the distance beside the path.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host/program/servo_run.hpp"

namespace lamplock::program_run {

struct ServoAxisErrors {
  double max_mm = 0, min_mm = 0;  ///< largest positive and negative error
  double rms_mm = 0;
  double max_pulses = 0;  ///< between the program, as the controller counts it, and the pulses
  double programmed_end_mm = 0, measured_end_mm = 0;
  long end_pulses = 0;
};

struct ServoErrors {
  std::string name;  ///< of the trajectory
  std::array<ServoAxisErrors, servo_axes> axis{};
  double beside_mm = 0;  ///< maximum distance from the path
  double moving_s = 0;
  std::size_t samples = 0;
};

/// `pulses_per_mm`: of the drives; run.steps_per_mm is the controller's value. The run must have
/// samples.
ServoErrors servo_errors(const ServoRun& run, double pulses_per_mm, const std::string& name);

/// Contour error: distance of the load from the path, over samples.
struct ContourError {
  double mean_mm = 0, deviation_mm = 0, max_mm = 0;  ///< deviation: standard deviation
};
ContourError contour_error(const std::vector<double>& beside_mm);

/// Distance of a sample's load from the path near it, mm.
double beside_path_mm(const ServoRun& run, std::size_t sample);

/// The table as text, lines with their ends.
std::string servo_table(const std::vector<ServoErrors>& rows);

}  // namespace lamplock::program_run
