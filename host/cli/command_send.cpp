// `lamplock send`: a job file, or a program of G-code, to a machine.
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/cli/board_options.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/finish_job.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/process_options.hpp"
#include "host/cli/program_document.hpp"
#include "host/run/event_stream.hpp"
#include "host/run/mode_name.hpp"
#include "host/run/program_events.hpp"
#include "host/run/report_job.hpp"
#include "host/run/run_program.hpp"
#include "host/run/send_job.hpp"
#include "host/run/sent_file.hpp"

namespace lamplock::cli {
namespace {

struct SendOptions {
  bool json = false;
  std::string file;
  run::BoardOptions board;
  run::ProgramOptions program;
  run::ProcessChoice material;
};

Json rows_json(const run::SentJob& sent, const std::string& board) {
  const run::PreparedJob& prepared = sent.prepared;
  const link::JobResult& result = sent.outcome.result;
  return {{"job", prepared.input},
          {"board", board},
          {"mode", run::mode_name(prepared.job.header.mode)},
          {"end", end_name(sent.outcome)},
          {"lines", prepared.job.size()},
          {"first_unfired", result.rest.first},
          {"may_have_fired", result.rest.from},
          {"seconds", std::chrono::duration<double>(result.elapsed).count()},
          {"planned_seconds", sent.planned_s},
          {"starvations", result.status.starvations},
          {"resent", result.resent},
          {"bad_frames", result.bad_frames + result.status.link.bad_frames},
          {"reconnects", result.reconnects},
          {"not_written", sent.outcome.lost.names()}};
}

/// A job contains its machine. A profile is that of the simulated board; for a real board only the
/// lines of the computer are used.
void check_job_options(const SendOptions& options) {
  const run::ProgramOptions& program = options.program;
  const std::array<std::pair<const char*, bool>, 9> of_programs{
      {{"--ignore-errors", program.ignore_errors},
       {"--events", !program.events.empty()},
       {"--user-commands", !program.user_commands.empty()},
       {"--probe-logs", !program.probe_logs.empty()},
       {"--material", options.material.material.has_value()},
       {"--laser", options.material.laser.has_value()},
       {"--thickness", options.material.thickness_mm.has_value()},
       {"--operation", options.material.operation.has_value()},
       {"--library", !options.material.library.empty()}}};
  for (const auto& [name, is_given] : of_programs)
    if (is_given)
      throw Error(Exit::bad_input, name, "is for programs of G-code, not for jobs", "leave it out");
  if (!program.machine.machine.empty()) program.machine.profile();  // a broken one is an error
}

/// Runs `read`. An error of it is the end of the events: it refuses the program.
template <class Read>
auto before_events(const std::string& events, const Read& read) {
  try {
    return read();
  } catch (const Error& error) {
    run::replace_events(events, error);
    throw;
  }
}

Exit send_program(const SendOptions& options, Console& console) {
  run::ProgramOptions program = options.program;
  program.process =
      before_events(program.events, [&] { return run::process_values(options.material); });
  if (program.process) console.say("material  {}", run::text_of(*program.process));
  const run::ProgramOutcome outcome =
      run::run_program(options.file, options.board, program, console);
  if (options.json) console.document(program_json(outcome));
  return run::judge_program(outcome, options.board.board, console);
}

Exit send_job(const SendOptions& options, Console& console) {
  check_job_options(options);
  run::BoardOptions board = options.board;
  run::SentJob sent = run::send_job(options.file, board, console);
  if (!sent.prepared.job.is_rows()) return finish_job(sent.outcome, board, console);
  console.document(rows_json(sent, board.board));
  return run::judge_end(sent.outcome, board, sent.prepared.job.item(), console);
}

Exit send_file(const SendOptions& options) {
  const bool has_events_on_stdout = options.program.events == run::EventStream::standard_output;
  if (has_events_on_stdout && options.json)
    throw Error(Exit::bad_input, "--events -", "--json writes to stdout, too",
                "give --events a file, or leave --json out");
  Console console(options.json || has_events_on_stdout);
  const run::SentKind kind =
      before_events(options.program.events, [&] { return run::kind_of_sent_file(options.file); });
  return kind == run::SentKind::program ? send_program(options, console)
                                        : send_job(options, console);
}

}  // namespace

void add_send(Command& program) {
  Command& app = program.add_command(
      "send", "Send a job or a G-code program to a machine and follow it to its end");
  app.footer(
      "The contents of FILE decide whether it is a job or a program, not its name.\n"
      "Programs (.gcode .nc .ngc .gc .tap .cnc) stop at their first error. While a program runs,\n"
      "Ctrl-C holds the machine and resets it when it is at rest. + or - and Enter changes the "
      "feed\n"
      "override by 10 %; = and Enter sets it to 100 %. While a job runs, Ctrl-C holds it, and the\n"
      "next Ctrl-C stops it. In a terminal, the key ! holds both, without Enter; Enter resumes.\n"
      "For jobs, --machine is the machine that a simulated board has; for a real board, lamplock\n"
      "reads only its table [lines] (GPIO).\n"
      "The progress of a job is kept in FILE.progress until the job is done. --resume continues\n"
      "after any end, also a power loss, and fires no point twice: points that may have been "
      "fired\n"
      "are skipped and written to FILE.progress.doubtful-A-B.xyz; --from A fires these points.\n"
      "Example:\n"
      "  lamplock send model.llj --board /dev/ttyACM0\n"
      "  lamplock send model.llj --board /dev/ttyACM0 --from 5120     # continue after a stop\n"
      "  lamplock send model.llj --board /dev/ttyACM0 --resume        # after any other end\n"
      "  lamplock send part.ngc --board /dev/ttyACM0\n"
      "  lamplock send part.ngc --board /dev/ttyUSB0 --baud 115200 --from 310 --dry\n"
      "  lamplock send probe.ngc --board /dev/ttyACM0 --probe-logs .\n"
      "  lamplock send part.ngc --board /dev/ttyACM0 --material plywood --thickness 5");
  const auto options = std::make_shared<SendOptions>();
  app.add_option("FILE", &options->file, "Job file (.llj) of points or rows, or G-code program")
      .required()
      .value_name("FILE")
      .file(FileUse::read);
  add_board(app, options->board, options->json);
  add_job_run(app, options->board);
  add_resume(app, options->board);
  app.add_option("--ignore-errors", &options->program.ignore_errors,
                 "Programs: continue after lines that the board refused")
      .group("Board");
  app.add_option("--events", &options->program.events,
                 "Programs: write each executed block as a line of JSON to a file, a pipe or "
                 "stdout (-) as soon as the board reports it")
      .value_name("PATH")
      .file(FileUse::write)
      .group("Board");
  add_machine(app, options->program.machine);
  add_process(app, options->material);
  add_user_commands(app, options->program.user_commands);
  app.add_option(
         "--probe-logs", &options->program.probe_logs,
         "Programs: folder in which (probeopen NAME) writes the places of contacts; without "
         "it no log is written")
      .value_name("FOLDER")
      .file(FileUse::folder)
      .group("Board");
  app.action([options, &program] {
    options->board.command = program.typed();
    options->board.profile = options->program.machine.machine;
    return send_file(*options);
  });
}

}  // namespace lamplock::cli
