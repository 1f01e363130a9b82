// Runs a G-code program to its end without a machine, with the firmware's interpreter and planner,
// fed in batches like on the board (line_work.hpp), by a sender without starvation.
//
// In:  the text of a program, the settings of a machine. It starts at machine zero, at rest.
// Out: errors by line and column; the exact time of the machine in ticks, without the restart after
//      a dwell or pause; distances, bounds, and the path for a picture. The time of a program with
//      points on the beat is that of the virtual board.
// Who: `lamplock check`; `lamplock send` before it sends; tests.
//
// All lines are run, those after M2 and M30 too, as a board runs them. Lines that begin with `$`
// are commands to the board, not part of the program: they are skipped; those that must not be in a
// program (board_lines.hpp), and bytes that are real-time commands, are problems of a file. A line
// with an error is skipped, as on a machine set to continue after errors; the time is that of the
// other lines. A pause (M0) takes no time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/program/board_state.hpp"
#include "host/program/locked_run.hpp"
#include "host/program/speed_change.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::program_run {

/// An error in a line.
struct Problem {
  std::size_t line = 0;  ///< from 1
  unsigned column = 0;   ///< from 1
  int error = 0;         ///< the machine's error number
  std::string text;      ///< what is wrong
  std::string remedy{};  ///< empty: none but to correct the line
};

/// A straight piece of the path, mm in machine coordinates; degrees of a rotary axis.
struct Piece {
  PerAxis<double> from{}, to{};
  double power = 0;        ///< of the laser or spindle: 0..1 of the maximum S
  double s = 0;            ///< S word while the laser or spindle is on, also of a rapid
  double feed_mm_min = 0;  ///< along the path, in G93 that of its time; 0: a rapid
  bool rapid = false;
  std::size_t line = 0;  ///< of the program, from 1
  std::size_t move = 0;  ///< number of its move, from 0: several pieces of a row are one move
};

/// A deque: a vector that grows would hold the pieces of a long program twice.
using Pieces = std::deque<Piece>;

/// Lowest and highest position of each axis.
struct Bounds {
  PerAxis<double> low{}, high{};
};

struct ProgramRun {
  std::size_t lines = 0;             ///< that are not blank
  std::size_t moves = 0;             ///< straight pieces of curves counted each
  double feed_mm = 0, rapid_mm = 0;  ///< along the axes that are lengths
  std::uint64_t ticks = 0;           ///< in motion
  std::uint64_t dwell_us = 0;        ///< dwells by G4 and cycles
  std::size_t pauses = 0;            ///< M0 and M1
  std::size_t locked = 0;            ///< moves that are locked to the beat (M130)
  std::size_t outside = 0;  ///< moves out of the work space that are not reported as problems
  LockedRun beats;          ///< of the whole program, if it has locked moves
  bool ended = false;       ///< it contains M2 or M30
  bool is_blank = true;     ///< no line is left without comments
  /// First line that may give light, in motion or at rest: M3 or M4 with an S above 0, points on
  /// the beat, outputs. 0: none.
  std::size_t light_line = 0;
  std::size_t system_line = 0;  ///< first line with another coordinate system than G54; 0: none
  int axes = 3;
  bool rotary = false;  ///< places of A are degrees ($967)
  Bounds bounds;        ///< of all moves, with the start
  std::vector<Problem> problems;
  std::vector<std::string> ignored;  ///< words without effect, each once
  Pieces pieces;
  /// Seconds from the begin of the program to the end of each move, with dwells; exact to some
  /// 20 ms, a batch of the planner. Of programs on the beat: in motion only.
  std::vector<double> move_ends_s;

  double seconds() const;
};

/// Runs a program on a machine with these tools; stops after `max_problems` lines with errors.
ProgramRun run_program(std::string_view text, const settings::Values& values,
                       std::size_t max_problems, const program::ToolTable& tools = {});

/// The board to which a program will be sent.
struct OnBoard {
  std::optional<BoardState> state;  ///< empty: unknown, the run begins at machine zero
  bool space_known = false;         ///< the work space is by the board's own settings
  /// Overrides that the user has changed. The time of points on the beat does not include them.
  std::vector<SpeedChange> changes{};
};

/// Runs the lines that a sender has chosen and checked. Motion outside of the work space is
/// a problem only if the state and the work space are known. Stops at the first problem. The time
/// (`beats`) of points on the beat is computed only for a board in its state after power-up.
ProgramRun run_on_board(std::string_view text, const settings::Values& values,
                        const OnBoard& board);

}  // namespace lamplock::program_run
