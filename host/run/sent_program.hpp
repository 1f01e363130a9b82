// A program of G-code as a board will get it: its lines, their check, their time.
//
// In:  the text of a file, the options of the user, settings and state of the board. Out: the lines
//      with O-words, process parameters, --from and --dry applied; the planned time; or an Error.
// Who: run_program().
#pragma once

#include <optional>
#include <string>

#include "host/link/board_settings.hpp"
#include "host/program/board_state.hpp"
#include "host/program/probe_log.hpp"
#include "host/program/process_values.hpp"
#include "host/run/board_options.hpp"
#include "host/run/program_refusal.hpp"
#include "host/run/program_time.hpp"
#include "host/run/user_commands.hpp"

namespace lamplock::run {

/// A program and what is known of it before it is sent.
struct SentProgram {
  ProgramText text;
  std::optional<double> planned_s;
  CommandLines commands{};                         ///< lines that the host executes
  std::vector<program_run::LoggedProbe> probes{};  ///< whose results are logged
  ProgramTime::Plan plan;  ///< the same with other overrides; empty if it is not known
};

/// What the user has chosen for the lines.
struct LineChoice {
  const program_run::ProcessValues* process = nullptr;  ///< of the material; null: none is chosen
  std::string user_commands{};                          ///< folder; empty: none are permitted
  bool logs_probes = false;  ///< adds questions after probes; needs the state of the board
};

/// Its lines as they are in the file. Throws Error(bad_input) for what can be refused before a
/// board is opened.
SentProgram program_of(const std::string& file, std::string text, const LineChoice& choice);

/// Makes the lines that the board gets. Throws Error(bad_input).
void choose_lines(SentProgram& program, const BoardOptions& options, const settings::Values& values,
                  const std::optional<program_run::BoardState>& state, const LineChoice& choice);

/// Why a program without O-words cannot begin with this line (--from); empty if it can.
std::string from_refusal(const ProgramText& text, std::size_t line, const settings::Values& values,
                         const std::optional<program_run::BoardState>& state);

/// Runs the program as the board will and stores its time and its plan, unless a line of it is
/// wrong. Throws Error(bad_input) at the first line that the board would refuse, unless
/// `ignore_errors`.
void predict(SentProgram& program, const link::BoardSettings& settings,
             const std::optional<program_run::BoardState>& state, bool ignore_errors);

}  // namespace lamplock::run
