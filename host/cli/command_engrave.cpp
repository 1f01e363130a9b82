// `lamplock engrave`: from a file to shots, all in one.
#include <memory>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/engraving.hpp"
#include "host/cli/job_board.hpp"
#include "host/cli/kept_progress.hpp"
#include "host/cli/origin.hpp"
#include "host/cli/report_job.hpp"
#include "host/cli/run_job.hpp"

namespace lamplock::cli {
namespace {

struct EngraveOptions {
  EngravingOptions engraving;
  BoardOptions board;
  OriginOption origin;
};

Exit engrave(EngraveOptions options) {
  options.board.profile = options.engraving.description().machine.profile;
  Console console(options.board.json);
  options.board.check(options.engraving.input, options.engraving.save_file());
  options.engraving.check_save();
  auto port = open_job_port(options.board);
  Work work =
      make_work(options.engraving, options.board.dry, console, options.origin.ask(port.get()));
  const auto kept = keep_progress(work, options.board, port.get(), console);
  take_off_fired(work, options.board);
  const Outcome outcome = run_job(work, options.board, std::move(port), console, kept.get());
  return report_job(outcome, options.board, console);
}

}  // namespace

void add_engrave(Command& program) {
  Command& app = program.add_command(
      "engrave",
      "Engrave a model, or all that a description says: points, order, job and machine in one");
  app.footer(
      "Example:\n  lamplock engrave model.stl --size 40 --spacing 0.3 --report report\n"
      "  lamplock engrave examples/block.toml --report report\n"
      "  lamplock engrave points.xyz --board /dev/ttyACM0 --machine machine.toml\n"
      "  lamplock engrave points.xyz --plot motion.svg --plot-beats 0,60 --hold-at 30\n\n"
      "On a real board the progress is kept in INPUT.progress until the job is done; the same\n"
      "command with --resume continues after any end, also a power loss, and fires no point "
      "twice.\n"
      "Ctrl-C holds the machine with the laser off, Enter resumes, Ctrl-C again stops. In a\n"
      "terminal a number and Enter is another job speed in percent, + or - and Enter a step.\n"
      "Exit status: 0 done, 1 job failed, 2 bad input, 3 no device, 130 interrupted.");
  const auto options = std::make_shared<EngraveOptions>();
  options->engraving.add(app, true);
  options->engraving.add_save(app);
  options->board.add_board(app);
  options->board.add_job(app);
  options->board.add_resume(app);
  options->origin.add(app);
  app.action([options] { return engrave(*options); });
}

}  // namespace lamplock::cli
