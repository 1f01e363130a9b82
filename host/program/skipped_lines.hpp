// The lines that `send --from` leaves out: their effect, and the lines that restore it.
//
// In:  the lines in their order, the settings of the machine, the state of the board before the
//      program. Out: lines for the board, or an Error about a line that cannot be left out.
// Who: start_at().
//
// The interpreter of the firmware runs the lines without a machine. What only the machine would
// know afterwards is refused: results of probes and inputs, offsets of the run (G10, G92), what
// user commands do. An axis is moved to its place only if the lines define it: by an absolute
// move after the last change of an offset that is not known.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/program/interpreter.hpp"
#include "host/link/program_lines.hpp"
#include "host/program/board_state.hpp"
#include "host/program/loaded_tool.hpp"
#include "host/program/program_words.hpp"
#include "host/program/start_outputs.hpp"
#include "host/program/start_tool.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::program_run {

/// G1 is in force without a feed, as M2 may leave it. In G93 each line has its own.
inline bool lacks_feed(const program::Modal& modal) {
  return modal.motion == program::Motion::line && modal.feed == 0 &&
         modal.feed_mode != program::FeedMode::inverse_time;
}

class SkippedLines {
 public:
  SkippedLines(const settings::Values& values, const std::string& file,
               const std::optional<BoardState>& state);

  /// Throws Error(bad_input): the line has an error or cannot be left out.
  void pass(const link::ProgramLine& line);
  /// Throws Error(bad_input) if the program cannot begin with `rest`, the lines from the first one
  /// on.
  void require_start(const std::vector<link::ProgramLine>& rest) const;
  /// The lines that come before the first one.
  std::vector<std::string> preamble() const;

 private:
  using Words = std::vector<ProgramWord>;

  [[noreturn]] void refuse(std::size_t line, const std::string& what,
                           std::string_view remedy) const;
  void check(const link::ProgramLine& line, const Words& words);
  void run(const link::ProgramLine& line);
  void note_places(const link::ProgramLine& line, const Words& words, const program::State& before);
  void note_machine_place(const Words& words);
  void lose_unknown(const Words& words, const program::State& before);
  void lose(std::size_t axis);
  void lose_turned(const program::State& state);
  void require_modes(std::size_t first) const;
  void require_motion(const std::vector<link::ProgramLine>& rest) const;
  std::string place_of(std::string_view axes) const;
  void add_parameters(std::vector<std::string>& lines) const;
  void add_modes(std::vector<std::string>& lines) const;
  void add_pulses(std::vector<std::string>& lines) const;
  void add_spindle(std::vector<std::string>& lines) const;

  const std::string& file_;
  const std::size_t axes_;
  const bool knows_offsets_;
  program::Parameters parameters_;
  const program::Options options_;
  program::Interpreter interpreter_{parameters_, options_};
  LoadedTool loaded_tool_;
  StartTool tool_;
  StartOutputs outputs_;
  std::array<bool, max_axes> placed_{};  ///< its position in the program is known
  std::array<bool, max_axes> lost_{};    ///< it was, before an unknown offset came into force
  bool is_beside_ = false;  ///< after G40 there was no move: the tool is beside the contour
  bool uses_rotation_ = false, uses_overrides_ = false;  ///< G68 or G69; M48 or M49
  std::string shift_;                                    ///< the last G92.1 or G92.2
};

}  // namespace lamplock::program_run
