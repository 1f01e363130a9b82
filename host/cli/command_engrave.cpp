// `lamplock engrave`: from a file to shots, all in one.
#include <memory>

#include "host/cli/board_options.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/engraving_options.hpp"
#include "host/cli/finish_job.hpp"
#include "host/cli/origin.hpp"
#include "host/run/engrave.hpp"

namespace lamplock::cli {
namespace {

struct EngraveOptions {
  bool json = false;
  EngravingOptions engraving;
  run::BoardOptions board;
  std::string origin = run::origin_machine;
};

Exit engrave(EngraveOptions options) {
  Console console(options.json);
  run::JobRequest request = options.engraving.request();
  request.origin = options.origin;
  run::JobOutcome outcome = run::engrave(request, options.board, console);
  return finish_job(outcome, options.board, console);
}

}  // namespace

void add_engrave(Command& program) {
  Command& app = program.add_command("engrave",
                                     "Engrave a model, or run a job description (TOML) that "
                                     "defines points, order, job and machine");
  app.footer(
      "Example:\n"
      "  lamplock engrave model.stl --size 40 --spacing 0.3 --report report\n"
      "  lamplock engrave examples/block.toml --report report\n"
      "  lamplock engrave points.xyz --board /dev/ttyACM0 --machine machine.toml\n"
      "  lamplock engrave points.xyz --plot motion.svg --plot-beats 0,60 --hold-at 30\n"
      "\n"
      "On a real board the progress is kept in INPUT.progress until the job is done; the same\n"
      "command with --resume continues after any end, also a power loss, and fires no point "
      "twice.\n"
      "In a terminal, the key ! or Ctrl-C holds the machine with the laser off; Enter resumes. "
      "The\n"
      "next Ctrl-C stops the job.\n"
      "Without a terminal the first one stops it. SIGTERM and SIGHUP always stop it.\n"
      "In a terminal, a number and Enter sets the job speed in percent; + or - and Enter changes\n"
      "it by one step.\n"
      "Exit status: 0 done, 1 job failed, 2 bad input, 3 no device; after a signal: 130 SIGINT\n"
      "(Ctrl-C), 143 SIGTERM, 129 SIGHUP.");
  const auto options = std::make_shared<EngraveOptions>();
  options->engraving.add(app, true);
  options->engraving.add_save(app);
  add_board(app, options->board, options->json);
  add_job_run(app, options->board);
  add_resume(app, options->board);
  add_origin(app, options->origin);
  app.action([options, &program] {
    options->board.command = program.typed();
    return engrave(*options);
  });
}

}  // namespace lamplock::cli
