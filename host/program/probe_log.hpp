// Probe logs of a program: `(probeopen NAME)`, `(probeclose)`, as LinuxCNC has them.
//
// In:  the lines that a board will get, its settings and state. Out: the same lines with a question
//      after each probe, if there are logs; from the answers the places in work coordinates.
// Who: `lamplock send --probe-logs`; `check` for the names.
//
// The question is a comment `(PRINT, ...#5061...)`, which the board answers with the values at that
// point of the program: the place of the contact, offsets, shift and tool length. So coordinates
// are exact to 10^-7 mm also where the program changes offsets by what it has probed; `[PRB:]` has
// three decimals, and the WCO of status reports may be that of another line. Only the rotation of
// G68 has no parameter: the host runs the lines, and corrects its position by every answer.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/program/interpreter.hpp"
#include "host/link/program_lines.hpp"
#include "host/program/board_state.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::program_run {

/// Names of the logs that the lines open, each once.
std::vector<std::string> log_names(const std::vector<link::ProgramLine>& lines);

/// A probe of a program that has logs.
struct LoggedProbe {
  std::size_t line = 0;  ///< index of its line; the next one is the question
  std::string log;       ///< name; empty: none is open, the answer only corrects the position
};

struct LoggedProgram {
  std::vector<link::ProgramLine> lines;
  std::vector<LoggedProbe> probes;
};

/// Adds the questions; none to a program without a log. `state`: of the board before the first
/// line.
LoggedProgram with_probe_questions(std::vector<link::ProgramLine> lines,
                                   const settings::Values& values, const BoardState& state);

/// A contact in the work coordinates that are active, in the program's unit: X Y Z A B C U V W.
/// Axes that do not exist are 0.
using LoggedPlace = std::array<double, 9>;

/// LinuxCNC's line of a log: nine numbers with six decimals.
std::string log_line(const LoggedPlace& place);

/// Reads the answers while the program runs.
class ProbeAnswers {
 public:
  /// `lines` and `probes`: of with_probe_questions(); they must outlive it.
  ProbeAnswers(const std::vector<link::ProgramLine>& lines, const std::vector<LoggedProbe>& probes,
               const settings::Values& values, const BoardState& state);

  struct Answer {
    std::size_t probe = 0;               ///< its index
    std::optional<LoggedPlace> place{};  ///< empty: no contact, or a part of the answer is missing
  };
  /// A text of the board, `[MSG:...]`. Empty if it is not an answer.
  std::optional<Answer> take(std::string_view text);

 private:
  void run_to(std::size_t line);
  LoggedPlace place();

  const std::vector<link::ProgramLine>& lines_;
  const std::vector<LoggedProbe>& probes_;
  program::Parameters parameters_;
  const program::Options options_;
  program::Interpreter interpreter_{parameters_, options_};
  std::size_t run_ = 0;  ///< lines
  std::size_t first_of_ = 0;
  std::vector<double> first_;  ///< values of the first half of an answer
  std::vector<double> second_;
};

}  // namespace lamplock::program_run
