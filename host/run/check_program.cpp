#include "host/run/check_program.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/link/program_lines.hpp"
#include "host/program/flow_unit.hpp"
#include "host/program/path_picture.hpp"
#include "host/program/program_flow.hpp"
#include "host/run/sent_file.hpp"
#include "host/run/tool_file.hpp"
#include "host/run/user_commands.hpp"

namespace lamplock::run {
namespace {

/// The lines that `send` would send; problems are those of the lines of the file.
program_run::ProgramRun run_with_flow(const std::string& text, const CheckOptions& options,
                                      const settings::Values& values,
                                      const program_run::ProcessValues* process,
                                      const program_run::BoardState& state) {
  const auto lines = program_run::run_flow(link::program_lines(text, options.input), options.input,
                                           values, state, process);
  std::string sent;
  for (const link::ProgramLine& line : lines) sent += line.text + "\n";
  if (!user_commands_of(lines, options.input, options.user_commands, false).empty())
    sent = program_run::without_user_commands(sent);
  auto run = program_run::run_program(sent, values, options.max_problems, state.parameters.tools);
  for (program_run::Problem& problem : run.problems) {
    const link::ProgramLine& line = lines[problem.line - 1];
    if (!line.origin.empty()) problem.text = fmt::format("in {}: {}", line.origin, problem.text);
    problem.line = line.number;
    problem.column = 0;  // of a line whose values are numbers
  }
  return run;
}

}  // namespace

program_run::ProgramRun check_program(const CheckOptions& options) {
  const job::Profile profile = options.machine.profile();
  if (!options.picture.empty()) {
    if (lower_extension(options.picture) != ".svg")
      throw Error(Exit::bad_input, options.picture, "pictures of a path are written as SVG",
                  "name it something.svg");
    check_target(options.picture);
  }
  program_run::BoardState state;
  if (!options.tools.empty()) state.parameters.tools = read_tools(options.tools);
  require_program(options.input);
  std::string text = read_program_text(options.input);
  const program_run::ProcessValues* process = options.process ? &*options.process : nullptr;
  program_run::check_process_values(text, options.input, process);
  const bool has_flow = program_run::has_flow(text);
  if (!has_flow && program_run::has_process_values(text))
    text = program_run::with_process_values(text, options.input, process, profile.settings, state);
  if (!has_flow && !user_commands_of(link::program_lines(text, options.input), options.input,
                                     options.user_commands, false)
                        .empty())
    text = program_run::without_user_commands(text);
  program_run::ProgramRun run =
      has_flow ? run_with_flow(text, options, profile.settings, process, state)
               : program_run::run_program(text, profile.settings, options.max_problems,
                                          state.parameters.tools);
  if (run.is_blank) throw no_line_to_send(options.input);
  if (!options.picture.empty())
    write_whole(options.picture, [&](const std::filesystem::path& path) {
      write_file(path, program_run::path_svg(
                           run, std::filesystem::path(options.input).filename().string()));
    });
  return run;
}

}  // namespace lamplock::run
