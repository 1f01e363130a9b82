// The path of a program as lines and arcs with what happens between them.
//
// In:  the text of a program, the settings of a machine. Out: its moves in order, each with the
//      vertices of the chords that the interpreter makes of a curve, and G-code for dwells,
//      coolant, pauses and the end. Who: `lamplock jerk`, which writes the program again with other
//      feeds, and `lamplock heat`.
//
// Coordinates are those of the machine, in mm.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::program_run {

enum class PathLaser { none, off, constant, proportional };  ///< none, M5, M3, M4

struct PathMove {
  std::size_t line = 0;  ///< from 1
  bool rapid = false;
  PathLaser laser = PathLaser::off;       ///< off where the machine has a spindle (setting 32)
  double s = 0;                           ///< S word
  double feed_mm_s = 0;                   ///< along the path; not of a rapid
  std::vector<PerAxis<double>> vertices;  ///< the start first; two for a straight move
};

/// A move, or a line of G-code if it has no vertices. A laser is switched on by its moves and for
/// its dwells, a spindle by lines. `move` of a dwell has its line, and its light if the board
/// permits that (setting 936).
struct PathStep {
  PathMove move{};
  std::string text{};
  double dwell_s = 0;  ///< 0: no dwell
};

/// Throws Error(bad_input) about FILE:LINE for a line with an error, and for one whose effect
/// cannot be written again: probing, points on the beat, pixels, outputs, inputs, tool changes.
/// `start_mm`: where the machine is at the begin.
std::vector<PathStep> program_path(std::string_view text, const settings::Values& values,
                                   const std::string& file, const PerAxis<double>& start_mm = {});

}  // namespace lamplock::program_run
