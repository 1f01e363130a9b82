// `lamplock send`: a job file, or a program of G-code, to a machine.
#include <memory>
#include <utility>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/job_board.hpp"
#include "host/cli/job_points.hpp"
#include "host/cli/kept_progress.hpp"
#include "host/cli/report_job.hpp"
#include "host/cli/run_job.hpp"
#include "host/cli/run_program.hpp"
#include "host/cli/run_rows.hpp"
#include "host/job/job_file.hpp"

namespace lamplock::cli {
namespace {

struct SendOptions {
  std::string file;
  BoardOptions board;
  ProgramOptions program;
};

/// A job says itself which machine it is for; of a profile it needs the computer's lines alone.
void check_job_options(const ProgramOptions& program) {
  if (program.go_on)
    throw Error(Exit::bad_input, "--go-on", "is for programs of G-code, not for jobs",
                "leave it out");
  if (!program.machine.machine.empty()) program.machine.profile();  // a broken one guards nothing
}

Exit send_file(const SendOptions& options) {
  if (is_program(options.file)) return send_program(options.file, options.board, options.program);
  check_job_options(options.program);
  Console console(options.board.json);
  options.board.check(options.file);
  auto port = open_job_port(options.board);
  Work work{options.file, {}, job::read_job_file(options.file), {}};
  work.job.header.dry = work.job.header.dry || options.board.dry;
  if (!work.job.is_rows()) work.points = points_of(work.job);
  BoardOptions board = options.board;
  const auto kept = keep_progress(work, board, port.get(), console);
  if (work.job.is_rows()) return send_rows(work, board, std::move(port), console, kept.get());
  take_off_fired(work, board);
  console.phase("job",
                fmt::format("{}: {} points, {}{}", options.file, work.points.size(),
                            mode_name(work.job.header.mode), work.job.header.dry ? ", dry" : ""));
  const Outcome outcome = run_job(work, board, std::move(port), console, kept.get());
  return report_job(outcome, board, console);
}

}  // namespace

void add_send(Command& program) {
  Command& app = program.add_command(
      "send", "Send a job or a program of G-code to a machine and see it through");
  app.footer(
      "Programs (.gcode .nc .ngc .gc .tap .cnc) stop at their first error. While one runs: Ctrl-C\n"
      "holds the machine and resets it once it stands; in a terminal ! and Enter holds, Enter\n"
      "alone goes on, and + - or = and Enter changes the feed. Of the --machine of a job only its\n"
      "lines of the computer are used.\n"
      "The progress of a job is kept in FILE.progress until it is done. --resume continues after\n"
      "any end, also a power loss, and fires no point twice: it leaves out the points that may\n"
      "have been fired and writes them to FILE.progress.doubtful-A-B.xyz; --from A fires them.\n"
      "Example:\n  lamplock send model.llj --board /dev/ttyACM0\n"
      "  lamplock send model.llj --board /dev/ttyACM0 --from 5120     # go on after a stop\n"
      "  lamplock send model.llj --board /dev/ttyACM0 --resume        # after any other end\n"
      "  lamplock send part.ngc --board /dev/ttyACM0\n"
      "  lamplock send part.ngc --board /dev/ttyUSB0 --baud 115200 --from 310 --dry");
  const auto options = std::make_shared<SendOptions>();
  app.add_option("FILE", &options->file, "Job file (.llj) of points or rows, or G-code")
      .required()
      .value_name("FILE");
  options->board.add_board(app);
  options->board.add_job(app);
  options->board.add_resume(app);
  app.add_option("--go-on", &options->program.go_on,
                 "Programs: go on after lines that were refused")
      .group("Board");
  options->program.machine.add_machine(app);
  app.action([options] {
    options->board.profile = options->program.machine.machine;
    return send_file(*options);
  });
}

}  // namespace lamplock::cli
