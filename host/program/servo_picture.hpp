// A picture of servo drives that follow programs: paths, and errors over time, as SVG.
//
// In:  sampled runs with their names. Out: text of an SVG file, some 40 KB per run: samples in one
//      pixel are drawn once.
// Who: `lamplock diagnose --picture`.
//
// A row for each run: on the left the programmed path and the one that the encoders measured, on
// the right programmed less measured of either axis, and one pulse, the resolution of the pulses.
// Colours are those of Okabe and Ito, which colour-blind people can distinguish.
#pragma once

#include <string>
#include <vector>

#include "host/program/servo_run.hpp"

namespace lamplock::program_run {

struct NamedServoRun {
  std::string name;
  ServoRun run;
};

/// The picture; `pulse_mm`: travel of one pulse.
std::string servo_svg(const std::vector<NamedServoRun>& runs, double pulse_mm);

}  // namespace lamplock::program_run
