#include "host/run/sent_program.hpp"

#include <algorithm>
#include <utility>

#include "host/program/flow_unit.hpp"
#include "host/program/loaded_tool.hpp"
#include "host/program/program_flow.hpp"
#include "host/program/program_run.hpp"
#include "host/program/start_at.hpp"
#include "host/program/without_laser.hpp"
#include "host/run/sent_file.hpp"

namespace lamplock::run {
namespace {

/// The board has reported all settings that define its work space.
bool knows_space(const link::BoardSettings& settings) {
  using settings::Id;
  if (!settings.has(Id::soft_limits)) return false;
  for (int axis = 0; axis < settings.values.whole(Id::axes); ++axis)
    for (const Id id : {Id::steps_per_mm_x, Id::travel_x, Id::min_corner_x})
      if (!settings.has(settings::for_axis(id, axis))) return false;
  return true;
}

/// Homing ends at a place that the host does not know.
bool homes(const SentProgram& program) {
  return std::any_of(program.text.lines.begin(), program.text.lines.end(), [](const auto& line) {
    return line.text.starts_with("$H") || line.text.starts_with("$h");
  });
}

/// The program as the board receives it.
std::string text_of(const SentProgram& program) {
  std::string sent;
  for (std::size_t i = 0; i < program.text.lines.size(); ++i) {
    sent += program.commands.contains(i) ? program_run::stand_in : program.text.lines[i].text;
    sent += '\n';
  }
  return sent;
}

/// The time of a run without problems [s]; nothing if it is not known.
std::optional<double> time_of(const program_run::ProgramRun& run) {
  const bool timed = run.outside == 0 && (run.locked == 0 || run.beats.seconds > 0);
  return timed ? std::optional(run.seconds()) : std::nullopt;
}

/// Plans the program again, with other overrides; those of points on the beat are not planned.
ProgramTime::Plan plan_of(const SentProgram& program, const link::BoardSettings& settings,
                          const program_run::OnBoard& board) {
  return [text = text_of(program), values = settings.values,
          board](const ProgramTime::Changes& changes) -> std::optional<double> {
    program_run::OnBoard changed = board;
    changed.changes = changes;
    const auto run = program_run::run_on_board(text, values, changed);
    return run.locked == 0 && run.problems.empty() ? time_of(run) : std::nullopt;
  };
}

}  // namespace

void predict(SentProgram& program, const link::BoardSettings& settings,
             const std::optional<program_run::BoardState>& state, bool ignore_errors) {
  if (!ignore_errors) check_board_lines(program.text);
  // Without its state and position, places outside of the work space are left to the board.
  const bool space_known = !homes(program) && knows_space(settings) &&
                           !program_run::uses_unknown_tool(program.text.lines, state);
  const program_run::OnBoard board{state, space_known};
  const auto run = program_run::run_on_board(text_of(program), settings.values, board);
  if (run.problems.empty()) {
    program.planned_s = time_of(run);
    program.plan = plan_of(program, settings, board);
    return;
  }
  if (ignore_errors) return;
  throw refusal_of(program.text, run.problems.front());
}

std::string from_refusal(const ProgramText& text, std::size_t line, const settings::Values& values,
                         const std::optional<program_run::BoardState>& state) {
  try {
    (void)program_run::start_at(link::program_lines(text.source, text.file), line, values,
                                text.file, state);
  } catch (const Error& error) {
    return std::string(error.message());
  }
  return {};
}

SentProgram program_of(const std::string& file, std::string text, const LineChoice& choice) {
  SentProgram program{{file, std::move(text), {}}, {}, {}, {}, {}};
  program.text.lines = link::program_lines(program.text.source, file);
  if (program.text.lines.empty()) throw no_line_to_send(file);
  refuse_sleep(program.text);
  program_run::check_process_values(program.text.source, file, choice.process);
  (void)user_commands_of(program.text.lines, file, choice.user_commands, true);
  return program;
}

void choose_lines(SentProgram& program, const BoardOptions& options, const settings::Values& values,
                  const std::optional<program_run::BoardState>& state, const LineChoice& choice) {
  if (program_run::has_flow(program.text.source)) {
    if (options.from != 0)
      throw Error(Exit::bad_input, program.text.file,
                  "--from cannot begin inside a program with O-words, M98 or values of user "
                  "commands",
                  "send the whole program");
    program.text.lines = program_run::run_flow(std::move(program.text.lines), program.text.file,
                                               values, state, choice.process);
    if (program.text.lines.empty()) throw no_line_to_send(program.text.file, true);
  } else if (program_run::has_process_values(program.text.source)) {
    program.text.source = program_run::with_process_values(program.text.source, program.text.file,
                                                           choice.process, values, state);
    program.text.lines = link::program_lines(program.text.source, program.text.file);
  }
  if (options.from != 0)
    program.text.lines =
        program_run::start_at(program.text.lines, options.from, values, program.text.file, state);
  if (options.dry)
    program.text.lines = program_run::without_laser(program.text.lines, program.text.file);
  program.text.lines =
      link::separate_messages(std::move(program.text.lines), program_run::is_user_command);
  if (choice.logs_probes && state) {
    auto logged = program_run::with_probe_questions(std::move(program.text.lines), values, *state);
    program.text.lines = std::move(logged.lines);
    program.probes = std::move(logged.probes);
  }
  program.commands =
      user_commands_of(program.text.lines, program.text.file, choice.user_commands, false);
}

}  // namespace lamplock::run
