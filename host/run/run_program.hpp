// Sends a program of G-code to a board and sees it through.
//
// In:  a file, where to run it. Out: how it went. Ctrl-C stops: the machine is held, and reset once
//      it is at rest.
// Who: `send`, `cut`.
#pragma once

#include <cstddef>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/link/line_sender.hpp"
#include "host/link/not_ready.hpp"
#include "host/program/process_values.hpp"
#include "host/run/board_options.hpp"
#include "host/run/frontend.hpp"
#include "host/run/lost_files.hpp"
#include "host/run/machine_options.hpp"

namespace lamplock::run {

/// Parts of a program that --from counts instead of its lines.
struct ProgramParts {
  std::string name{};                      ///< of one of them
  std::vector<std::size_t> first_lines{};  ///< of each, ascending, from 1
  std::vector<std::size_t> numbers{};      ///< of each
};

/// What is about programs alone.
struct ProgramOptions {
  bool ignore_errors = false;  ///< continues after lines that the board refused
  MachineOptions machine{};
  std::optional<program_run::ProcessValues> process{};  ///< of the chosen material
  std::string user_commands{};  ///< folder of M100 to M199; empty: none are permitted
  std::string events{};         ///< file of the executed blocks, "-": stdout; empty: none
  std::string probe_logs{};     ///< folder of (probeopen NAME); empty: no log is written
  ProgramParts parts{};         ///< by which the user continues; empty: by lines
};

/// A program that was sent.
struct ProgramOutcome {
  std::string file;
  std::size_t lines = 0;
  std::optional<double> planned_s{};
  link::LineResult result{};
  link::Homing homing{};       ///< as the board has reported it
  ProgramParts parts{};        ///< as ProgramOptions
  bool rotary = false;         ///< places of A are degrees
  bool has_flow = false;       ///< O-words and the like, within which --from cannot begin
  std::string from_refusal{};  ///< why --from with the line under way is refused; empty: it is not
  std::string ended_by{};      ///< the line of the computer that stopped it; empty if none did
  bool lacks_user = false;     ///< a fault has held it, and there was no terminal to resume it
  LostFiles lost{};
  std::string lost_events{};   ///< file of the executed blocks that is not complete; empty: none
  std::exception_ptr error{};  ///< why it ended, after lines were sent, if by an error
};

/// The end of a program, for scripts; "failed": by an error of the host.
const char* end_name(const ProgramOutcome& outcome);

/// Throws Error for what can be refused before a board is opened: its name, options of jobs,
/// outputs that are one of `files`, no terminal to ask for permission.
void check_program_options(const BoardOptions& options, const std::vector<std::string>& files,
                           Frontend& frontend);

/// Sends it and waits for its end. Throws Error where nothing was sent.
ProgramOutcome run_program(const std::string& file, const BoardOptions& options,
                           const ProgramOptions& asked, Frontend& frontend);

/// The same of a program that is not in a file; `name` is its name in messages.
ProgramOutcome run_program_text(const std::string& name, std::string text,
                                const BoardOptions& options, const ProgramOptions& asked,
                                Frontend& frontend);

/// Exit status of a program, with a notice if the user has stopped it, and for each file that is
/// lost. Throws Error for every other end before its last line.
Exit judge_program(const ProgramOutcome& outcome, const std::string& board, Frontend& frontend);

}  // namespace lamplock::run
