// A picture of how servo drives followed their programs: paths, and errors over time, as SVG.
//
// In:  sampled runs with their names. Out: text of an SVG file, some forty kilobytes a run: what
//      shares a pixel is drawn once.
// Who: `lamplock diagnose --picture`.
//
// A row for each run: on the left the path that was programmed and the one that the encoders saw,
// on the right programmed less measured of either axis, and the pulse that bounds what pulses can
// say. Colours are those of Okabe and Ito, which colour-blind people can tell apart.
#pragma once

#include <string>
#include <vector>

#include "host/program/servo_run.hpp"

namespace lamplock::report {

struct NamedServoRun {
  std::string name;
  program_run::ServoRun run;
};

/// The picture; `pulse_mm`: what a pulse moves.
std::string servo_svg(const std::vector<NamedServoRun>& runs, double pulse_mm);

}  // namespace lamplock::report
