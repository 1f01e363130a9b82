#include "host/run/run_program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "host/duration_text.hpp"
#include "host/file.hpp"
#include "host/link/board_settings.hpp"
#include "host/link/board_text.hpp"
#include "host/link/line_sender.hpp"
#include "host/link/not_ready.hpp"
#include "host/program/board_state.hpp"
#include "host/program/flow_unit.hpp"
#include "host/program/kept_parameters.hpp"
#include "host/program/loaded_tool.hpp"
#include "host/run/before_firing.hpp"
#include "host/run/board_files.hpp"
#include "host/run/board_link.hpp"
#include "host/run/frontend.hpp"
#include "host/run/other_board.hpp"
#include "host/run/permission.hpp"
#include "host/run/probe_log_files.hpp"
#include "host/run/process_choice.hpp"
#include "host/run/program_control.hpp"
#include "host/run/program_events.hpp"
#include "host/run/program_time.hpp"
#include "host/run/sent_file.hpp"
#include "host/run/sent_program.hpp"
#include "host/run/simulated_boards.hpp"
#include "host/run/supervisor.hpp"
#include "shared/units.hpp"
#include "shared/work_space.hpp"

namespace lamplock::run {
namespace {

using link::LineEnd;
using link::LineResult;

/// Refuses options that are for jobs.
void check_options(const BoardOptions& options) {
  const std::array<std::pair<const char*, bool>, 11> of_jobs{
      {{"--fired", options.fired != 0},
       {"--job-speed", options.job_speed != 100},
       {"--auto-resume", options.auto_resume},
       {"--discard", options.discard},
       {"--resume", options.resume},
       {"--progress", !options.progress.empty()},
       {"--hold-at", options.hold_at != 0},
       {"--report", !options.report.empty()},
       {"--statistics", !options.statistics.empty()},
       {"--timing", !options.timing.empty()},
       {"--plot", options.plot.any()}}};
  for (const auto& [name, given] : of_jobs)
    if (given)
      throw Error(Exit::bad_input, name, "is for jobs, not for programs of G-code", "leave it out");
}

/// A machine that moves, and a laser, need a permission.
void ask_permission(const SentProgram& program, const BoardOptions& options, Frontend& frontend) {
  const std::string question = fmt::format(
      "{}: {} lines on {}: the machine will move{}. Type yes to start: ", program.text.file,
      program.text.lines.size(), options.board, options.dry ? "" : ", its laser may fire");
  require_permission(options, frontend, question, program.text.file, "nothing was sent");
}

/// Settings of a board; nothing if it has none of ours or does not tell them.
std::optional<link::BoardSettings> settings_of(link::LinePort& port) {
  try {
    link::BoardSettings settings = link::read_settings(port);
    if (settings.known.any()) return settings;
  } catch (const Error& error) {
    if (error.exit() == Exit::no_device) throw;
  }
  return std::nullopt;
}

std::string place_text(const link::BoardStatus& status) {
  std::string text;
  for (std::size_t a = 0; a < status.position.size() && a < axis_letters.size(); ++a)
    text += fmt::format("{}{}{:.3f}", a == 0 ? "" : " ", axis_letters[a], status.position[a]);
  return text.empty() ? "an unknown place" : text;
}

std::string error_line(const std::string& file, const link::LineError& error) {
  return fmt::format("{}:{}: {}", file, error.line, link::error_text(error.error));
}

/// Shows lines that were refused while the program continues.
class RefusedLines {
 public:
  RefusedLines(const std::string& file, Progress& progress) : file_(file), progress_(progress) {}
  void show(const std::vector<link::LineError>& errors) {
    for (; shown_ < errors.size(); ++shown_) progress_.note(error_line(file_, errors[shown_]));
  }

 private:
  const std::string& file_;
  Progress& progress_;
  std::size_t shown_ = 0;
};

/// What follows a program while it runs; null: it is not wanted.
struct Followers {
  ProgramEvents* events = nullptr;
  ProbeLogFiles* logs = nullptr;
};

/// The files of its probe logs; null without --probe-logs or a log. Throws Error(bad_input) if they
/// cannot be written, or the board does not report what they need.
std::unique_ptr<ProbeLogFiles> probe_logs_of(const SentProgram& program,
                                             const ProgramOptions& asked, const std::string& board,
                                             const std::optional<link::BoardSettings>& of_board,
                                             const std::optional<program_run::BoardState>& state,
                                             Frontend& frontend) {
  const auto names = program_run::log_names(program.text.lines);
  if (names.empty()) return {};
  if (asked.probe_logs.empty()) {
    frontend.notice(
        fmt::format("note: {}: its probe log ({}) is not written; --probe-logs FOLDER writes it",
                    program.text.file, fmt::join(names, ", ")));
    return {};
  }
  ProbeLogFiles::check(asked.probe_logs, names, program.text.file);
  if (!of_board || !state)
    throw Error(Exit::bad_input, board,
                "does not report the settings, offsets and modes that a probe log needs",
                "leave --probe-logs out, or end G68 and M130 before the program");
  if (program_run::uses_unknown_tool(program.text.lines, state))
    throw Error(Exit::bad_input, board,
                "does not report the tool in the spindle, which a probe log needs",
                std::string(program_run::unknown_tool_remedy));
  return std::make_unique<ProbeLogFiles>(program.text.lines, program.probes, asked.probe_logs,
                                         of_board->values, *state);
}

/// Sends the program to its end. Throws Error if an error has ended it before its first line; later
/// errors are part of the outcome.
ProgramOutcome send(const SentProgram& program, BoardLink& board, const BoardOptions& options,
                    const ProgramOptions& asked, const Followers& followers, Frontend& frontend) {
  const auto [events, logs] = followers;
  const bool ignore_errors = asked.ignore_errors;
  const std::unique_ptr<Progress> progress =
      frontend.progress("sending", program.text.lines.size(), 0);
  link::LineOptions sending;
  sending.ignore_errors = ignore_errors;
  if (events != nullptr) sending.status_interval = ProgramEvents::status_interval;
  const link::LineSender* running = nullptr;
  sending.on_text = [&progress, &running, logs = logs](const std::string& text) {
    if (logs != nullptr && running != nullptr && logs->take(text, *running)) return;
    progress->note("machine: " + link::message_text(text));
  };
  UserCommands commands(program.commands, program.text, asked.user_commands, *progress);
  sending.host_lines = &commands;
  link::LineSender sender(board.port(), program.text.lines, sending);
  running = &sender;
  ProgramTime time(program.planned_s, program.plan);
  ProgramControl control(sender, frontend, *progress, board.clocking(), time);
  RefusedLines refused(program.text.file, *progress);
  Supervisor supervisor(options, board.port().transport());
  before_firing([&] { supervisor.begin(gpio::LaserUse::laser); });
  const auto supervise = [&, events = events, logs = logs] {
    try {
      control.poll();
      supervisor.poll(control, AtDoor::holds);
      if (ignore_errors) refused.show(sender.errors());
      if (events != nullptr) events->poll(sender, *progress);
      if (logs != nullptr) logs->poll(sender);
    } catch (...) {  // a terminal that has gone must not leave the machine running
      sender.fail(std::current_exception());
    }
  };
  ProgramOutcome outcome{program.text.file, program.text.lines.size(), program.planned_s};
  outcome.has_flow = program_run::has_flow(program.text.source);
  try {
    while (sender.step()) supervise();
    supervisor.end();
    if (ignore_errors) refused.show(sender.errors());
  } catch (...) {
    if (sender.result().sent == 0) before_firing([] { throw; });
    outcome.error = std::current_exception();
  }
  outcome.result = sender.result();
  outcome.ended_by = supervisor.ended_by();
  outcome.lacks_user = control.lacks_user();
  if (events != nullptr) events->end(sender, end_name(outcome), *progress);
  if (logs != nullptr) logs->finish(outcome.lost);
  return outcome;
}

/// Writes the files about a simulated board; what cannot be written is lost.
void write_files(ProgramOutcome& outcome, PinTrace* trace, const BoardOptions& options,
                 const sim::Board* board, const settings::Values& values) {
  if (trace != nullptr) outcome.lost.attempt(options.vcd, [trace] { trace->finish(); });
  if (!options.shots.empty())
    outcome.lost.attempt(options.shots, [&] { write_shots(options.shots, *board, values); });
}

/// The number of the part with this line; lines before the first part belong to it.
std::size_t part_with(const ProgramParts& parts, std::size_t line) {
  const auto next = std::upper_bound(parts.first_lines.begin() + 1, parts.first_lines.end(), line);
  return parts.numbers[static_cast<std::size_t>(next - parts.first_lines.begin()) - 1];
}

/// Whether the same command can begin with the line that was under way.
std::string from_text(const ProgramOutcome& outcome) {
  if (outcome.has_flow) return {};
  const std::size_t line = outcome.result.at_line;
  if (!outcome.from_refusal.empty())
    return fmt::format("; --from {} cannot begin with it ({})", line, outcome.from_refusal);
  return fmt::format("; the same command with --from {} begins with it", line);
}

/// How far it came. What the machine has accepted is not all done: it plans ahead.
std::string reach_text(const ProgramOutcome& outcome) {
  const LineResult& result = outcome.result;
  if (result.last_line == 0) return "no line was accepted";
  const ProgramParts& parts = outcome.parts;
  if (!parts.numbers.empty()) {
    const std::size_t number = part_with(parts, result.at_line ? result.at_line : result.last_line);
    if (result.at_line == 0)
      return fmt::format("the last line that it accepted is one of {} {}, at {}", parts.name,
                         number, place_text(result.status));
    return fmt::format(
        "{0} {1} was under way, at {2}; the same command with --from {1} begins with it",
        parts.name, number, place_text(result.status));
  }
  if (result.at_line != 0)
    return fmt::format("line {0} of {1} was under way, at {2}{3}", result.at_line, outcome.file,
                       place_text(result.status), from_text(outcome));
  return fmt::format("line {} of {} was the last one that it accepted, at {}", result.last_line,
                     outcome.file, place_text(result.status));
}

[[noreturn]] void fail(const std::string& where, const std::string& what,
                       const std::string& remedy) {
  throw Error(Exit::job_failed, where, what, remedy);
}

std::string alarm_of(const LineResult& result) {
  return result.alarm == 0 ? "alarm" : link::alarm_text(result.alarm);
}

/// The way out of an alarm, after its cause; a simulated board has forgotten it.
std::string then_unlock(const std::string& board, link::Homing homing) {
  const bool is_simulated = board == virtual_board || board == chip_board;
  return is_simulated ? "" : ", then " + link::way_to_unlock(board, homing);
}

/// A reset in motion is an alarm.
bool was_stopped(LineEnd end) { return end == LineEnd::stopped || end == LineEnd::alarm; }

/// An error after the first line is a failed job, whatever it is an error of.
Exit judge_failure(const std::exception_ptr& error, const std::string& reach, Frontend& frontend) {
  try {
    std::rethrow_exception(error);
  } catch (const Error& failure) {
    frontend.notice(failure.what());
  }
  frontend.notice(reach);
  return Exit::job_failed;
}

/// Exit status of a program without regard to files, with a notice if the user has stopped it.
/// Throws Error for every other end before its last line.
Exit judge(const ProgramOutcome& outcome, const std::string& board, Frontend& frontend) {
  const LineResult& result = outcome.result;
  const std::string reach = reach_text(outcome);
  if (outcome.error) return judge_failure(outcome.error, reach, frontend);
  std::string what, remedy;
  switch (result.end) {
    case LineEnd::done:
      if (result.errors.empty()) return Exit::done;
      fail(outcome.file,
           fmt::format("{} of {} lines were refused", result.errors.size(), outcome.lines),
           "the list above says which and why");
    case LineEnd::error:
      fail(fmt::format("{}:{}", outcome.file, result.errors.front().line),
           link::error_text(result.errors.front().error),
           fmt::format("correct the line; the machine is at rest, {}", reach));
    case LineEnd::stopped:
      if (outcome.lacks_user)
        fail(outcome.file, "the machine held, and no terminal can resume it; " + reach,
             "see its message above");
      frontend.notice("stopped: " + reach);
      return Exit::interrupted;
    case LineEnd::alarm:
      fail(board, fmt::format("{}, {}", alarm_of(result), reach),
           "see what stopped it" + then_unlock(board, outcome.homing));
    case LineEnd::lost:
      what = "connection lost, so that the machine could not be stopped";
      remedy = "check that it is at rest, and check the cable";
      break;
    case LineEnd::unanswered:
      what = "is idle but did not acknowledge all lines";
      remedy = "check the cable, and that nothing else uses the port";
      break;
    case LineEnd::restarted:
      what = "has restarted, its position may be lost";
      remedy = "home it and send the program again";
      break;
  }
  fail(board, fmt::format("{}; {}", what, reach), remedy);
}

ProgramOutcome run_text(const std::string& name, std::string text, const BoardOptions& options,
                        const ProgramOptions& asked, const OpenedEvents& opened,
                        Frontend& frontend) {
  const LineChoice choice{asked.process ? &*asked.process : nullptr, asked.user_commands,
                          !asked.probe_logs.empty()};
  const std::string source = text;
  SentProgram program = program_of(name, std::move(text), choice);
  const settings::Values values = asked.machine.profile().settings;
  BoardLink board(options, values);
  ask_permission(program, options, frontend);
  board.unlock_simulated();
  const link::BoardStatus status = link::greet(board.port()).status;
  const auto of_board = settings_of(board.port());
  if (of_board && !asked.machine.machine.empty())
    refuse_file_of_other_board(asked.machine.machine, values.whole(settings::Id::pin_map),
                               *of_board);
  std::optional<program_run::BoardState> state;
  if (of_board) state = program_run::read_state(board.port(), status, inch_axes(of_board->values));
  choose_lines(program, options, of_board ? of_board->values : values, state, choice);
  if (asked.process)
    if (const std::string note = unused_choice_note(name, source, program.text.lines);
        !note.empty())
      frontend.notice(note);
  const auto logs = probe_logs_of(program, asked, options.board, of_board, state, frontend);
  if (of_board) predict(program, *of_board, state, asked.ignore_errors);
  std::optional<PinTrace> trace;
  if (!options.vcd.empty()) trace.emplace(options.vcd, *board.simulated());
  std::optional<ProgramEvents> events;
  if (opened.stream != nullptr)
    events.emplace(*opened.stream, asked.events, program.text.lines,
                   of_board ? of_board->values : values, state ? &*state : nullptr);
  if (const std::string note =
          program_run::clear_kept_parameters(board.port(), program.text.lines, program.text.file);
      !note.empty())
    frontend.notice(note);
  ProgramOutcome outcome =
      send(program, board, options, asked, {events ? &*events : nullptr, logs.get()}, frontend);
  opened.is_sent = true;
  outcome.parts = asked.parts;
  if (outcome.result.at_line != 0 && !outcome.has_flow)
    outcome.from_refusal = from_refusal(program.text, outcome.result.at_line,
                                        of_board ? of_board->values : values, state);
  if (events && events->is_lost()) outcome.lost_events = asked.events;
  if (of_board) outcome.homing = link::homing_of(*of_board);
  outcome.rotary = of_board && is_rotary(of_board->values, rotary_axis);
  write_files(outcome, trace ? &*trace : nullptr, options, board.simulated(), values);
  const LineResult& result = outcome.result;
  frontend.say("{:<8}  {} of {} lines in {}, at {}", end_name(outcome), result.executed,
               outcome.lines, duration_text(std::chrono::duration<double>(result.elapsed).count()),
               place_text(result.status));
  return outcome;
}

}  // namespace

const char* end_name(const ProgramOutcome& outcome) {
  if (outcome.error) return "failed";
  constexpr std::array names{"done", "error",      "stopped",  "alarm",
                             "lost", "unanswered", "restarted"};
  return names[static_cast<std::size_t>(outcome.result.end)];
}

void check_program_options(const BoardOptions& options, const std::vector<std::string>& files,
                           Frontend& frontend) {
  check_options(options);
  options.check(files);
  require_askable(options, frontend);
}

ProgramOutcome run_program(const std::string& file, const BoardOptions& options,
                           const ProgramOptions& asked, Frontend& frontend) {
  return with_events(asked.events, [&](const OpenedEvents& events) {
    check_program_options(options, {file}, frontend);
    return run_text(file, read_program_text(file), options, asked, events, frontend);
  });
}

ProgramOutcome run_program_text(const std::string& name, std::string text,
                                const BoardOptions& options, const ProgramOptions& asked,
                                Frontend& frontend) {
  return with_events(asked.events, [&](const OpenedEvents& events) {
    check_program_options(options, {}, frontend);
    return run_text(name, std::move(text), options, asked, events, frontend);
  });
}

Exit judge_program(const ProgramOutcome& outcome, const std::string& board, Frontend& frontend) {
  const bool is_done = !outcome.error && outcome.result.end == LineEnd::done;
  const Exit exit = outcome.lost.report(
      Exit::done, is_done ? "the program was run" : "the program ended early", frontend);
  if (!outcome.error && !outcome.ended_by.empty() && was_stopped(outcome.result.end))
    throw_stopped(outcome.ended_by, reach_text(outcome),
                  "release it" + then_unlock(board, outcome.homing));
  const Exit of_machine = judge(outcome, board, frontend);
  return of_machine == Exit::done ? exit : of_machine;
}

}  // namespace lamplock::run
