#include "host/run/check_program.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "host/error.hpp"
#include "host/file/staged_file.hpp"
#include "host/link/program_lines.hpp"
#include "host/program/flow_unit.hpp"
#include "host/program/path_picture.hpp"
#include "host/program/probe_log.hpp"
#include "host/program/process_values.hpp"
#include "host/program/program_flow.hpp"
#include "host/program/tool_file.hpp"
#include "host/run/process_choice.hpp"
#include "host/run/program_refusal.hpp"
#include "host/run/sent_file.hpp"
#include "host/run/user_commands.hpp"

namespace lamplock::run {
namespace {

using Lines = std::vector<link::ProgramLine>;

/// The lines that `send` would send of this text; problems are those of the lines of the file.
program_run::ProgramRun run_with_flow(const Lines& lines, const std::string& text,
                                      const CheckOptions& options, const settings::Values& values,
                                      const program::ToolTable& tools) {
  std::string sent;
  for (const link::ProgramLine& line : lines) sent += line.text + "\n";
  if (!user_commands_of(lines, options.input, options.user_commands, false).empty())
    sent = program_run::without_user_commands(sent);
  auto run = program_run::run_program(sent, values, options.max_problems, tools);
  const ProgramText program{options.input, text, lines};
  for (program_run::Problem& problem : run.problems) problem = in_file(program, std::move(problem));
  return run;
}

/// The lines of a file without O-words; problems of user commands get the name of the command.
program_run::ProgramRun run_without_flow(const Lines& lines, std::string text,
                                         const CheckOptions& options,
                                         const settings::Values& values,
                                         const program::ToolTable& tools) {
  const auto commands = user_commands_of(lines, options.input, options.user_commands, false);
  const ProgramText program{options.input, text, lines};
  if (!commands.empty()) text = program_run::without_user_commands(text);
  auto run = program_run::run_program(text, values, options.max_problems, tools);
  for (program_run::Problem& problem : run.problems)
    for (const auto& [index, command] : commands)
      if (lines[index].number == problem.line) {
        problem.line = index + 1;
        problem = in_file(program, std::move(problem));
        break;
      }
  return run;
}

/// `text`: of the file.
void add_notes(CheckedProgram& checked, const std::string& text, const Lines& lines,
               const CheckOptions& options) {
  checked.probe_logs = program_run::log_names(lines);
  if (options.process)
    if (std::string note = unused_choice_note(options.input, text, lines); !note.empty())
      checked.notes.push_back(std::move(note));
}

void check_picture_name(const std::string& picture) {
  if (picture.empty()) return;
  require_extension(picture, ".svg", "pictures of a path are written as SVG");
  check_target(picture);
}

}  // namespace

CheckedProgram check_program(const CheckOptions& options) {
  const settings::Values values = options.machine.profile().settings;
  check_picture_name(options.picture);
  program_run::BoardState state;
  if (!options.tools.empty())
    state.parameters.tools = program_run::tools_of(read_program_text(options.tools), options.tools);
  require_program(options.input);
  std::string text = read_program_text(options.input);
  const program_run::ProcessValues* process = options.process ? &*options.process : nullptr;
  program_run::check_process_values(text, options.input, process);
  CheckedProgram checked;
  const bool has_flow = program_run::has_flow(text);
  if (has_flow) {
    const Lines lines = program_run::run_flow(link::program_lines(text, options.input),
                                              options.input, values, state, process);
    checked = {run_with_flow(lines, text, options, values, state.parameters.tools)};
    checked.is_blank = lines.empty();
    add_notes(checked, text, lines, options);
  } else {
    const std::string source = text;
    if (program_run::has_process_values(text))
      text = program_run::with_process_values(text, options.input, process, values, state);
    const Lines lines = link::program_lines(text, options.input);
    checked = {run_without_flow(lines, text, options, values, state.parameters.tools)};
    add_notes(checked, source, lines, options);
  }
  if (checked.is_blank) throw no_line_to_send(options.input, has_flow);
  if (!options.picture.empty())
    write_whole(
        options.picture,
        program_run::path_svg(checked, std::filesystem::path(options.input).filename().string()));
  return checked;
}

}  // namespace lamplock::run
