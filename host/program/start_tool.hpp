// The tool and the tool length of lines that `send --from` leaves out, and the lines that restore
// them.
//
// In:  the lines that are left out, after the interpreter has run them; the state of the board.
// Out: lines with T, M6 or M61, G43 to G49. M6 waits for the operator, so it is there only if the
//      tool of the lines is not the one that the board reports in its spindle.
// Who: SkippedLines.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/program/modal.hpp"
#include "firmware/program/parameters.hpp"
#include "host/program/board_state.hpp"
#include "host/program/program_words.hpp"

namespace lamplock::program_run {

class StartTool {
 public:
  /// `parameters`: of the interpreter that runs the lines.
  StartTool(const std::optional<BoardState>& state, const program::Parameters& parameters);

  /// Notes the tool words of a line; `after`: the modes after it. False if the line has a length
  /// that cannot be restored: an H with an expression.
  bool pass(const std::vector<ProgramWord>& words, const program::Modal& after);
  /// The tool length in force is older than the last M6, at which the operator may have touched off
  /// the tool: it is known only if it is the one that the board has.
  bool has_length_of_operator(const program::Modal& at_end) const;
  void add_lines(std::vector<std::string>& lines, const program::Modal& at_end) const;

 private:
  enum class Loading { none, change, set };  // M6, M61

  bool note_length(const std::vector<ProgramWord>& words, const program::Modal& after);

  const program::Parameters& parameters_;
  std::optional<std::uint32_t> loaded_;  ///< that the board reports
  std::optional<std::int64_t> length_of_board_e7_;
  bool knows_selected_;  ///< the tool of the last T
  bool selects_ = false;
  Loading loading_ = Loading::none;   ///< the last one
  std::vector<std::string> lengths_;  ///< since the last length that replaces others
  bool changes_after_length_ = false;
};

}  // namespace lamplock::program_run
