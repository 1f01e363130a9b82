// A program of G-code, run to its end without a machine: the firmware's interpreter and planner,
// fed in batches as the board feeds it (line_work.hpp), by a sender whose lines never run out.
//
// In:  the text of a program, the settings of a machine. It starts at machine zero, at rest.
// Out: what is wrong with it, by line and column; the time that the machine will take, to the
//      tick but for what it needs to begin anew after a dwell or pause; ways, bounds, and the path
//      for a picture. A program with points on the beat takes what the virtual board takes.
// Who: `lamplock check`; `lamplock send` before it sends; tests.
//
// Lines that begin with `$` are for the board and say nothing of the program: they are passed over.
// A line that is wrong is left out, as the machine would with $-setting "go on after an error"; the
// time is then that of the rest. A pause (M0) takes no time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/program/board_state.hpp"
#include "host/program/locked_run.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::program_run {

/// Something wrong with a line.
struct Problem {
  std::size_t line = 0;  ///< from 1
  unsigned column = 0;   ///< from 1
  int error = 0;         ///< number as the machine says it
  std::string text;      ///< what that number means
};

/// A straight piece of the path, mm in machine coordinates.
struct Piece {
  PerAxis<double> from{}, to{};
  double power = 0;  ///< of the laser or spindle: 0..1 of the highest S
  bool rapid = false;
};

/// Lowest and highest place on each axis.
struct Bounds {
  PerAxis<double> low{}, high{};
};

struct ProgramRun {
  std::size_t lines = 0;  ///< that are not blank
  std::size_t moves = 0;  ///< straight pieces of curves counted each
  double feed_mm = 0, rapid_mm = 0;
  std::uint64_t ticks = 0;     ///< in motion
  std::uint64_t dwell_us = 0;  ///< standing by G4 and cycles
  std::size_t pauses = 0;      ///< M0 and M1
  std::size_t locked = 0;      ///< moves that are locked to the beat (M130)
  std::size_t outside = 0;     ///< moves to places outside of the work space that are no problems
  LockedRun beats;             ///< of all of it, if there are such
  bool ended = false;          ///< by M2 or M30
  int axes = 3;
  Bounds bounds;  ///< of all moves, where it starts included
  std::vector<Problem> problems;
  std::vector<Piece> pieces;

  double seconds() const;
};

/// Runs it. `most_problems`: gives up when so many lines were wrong.
ProgramRun run_program(std::string_view text, const settings::Values& values,
                       std::size_t most_problems);

/// A board that a program is about to be sent to.
struct OnBoard {
  std::optional<BoardState> state;  ///< nothing: not known, the run begins at machine zero
  bool space_known = false;         ///< the settings of its work space are its own
};

/// Runs all lines, those after M2 and M30 too: the board does so. Motion outside of the work space
/// is a problem only if the state and the work space are known. Gives up at the first problem.
/// Without the time (`beats`) of points on the beat for a board that is not as after power-up.
ProgramRun run_on_board(std::string_view text, const settings::Values& values,
                        const OnBoard& board);

}  // namespace lamplock::program_run
