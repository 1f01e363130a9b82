// `lamplock send`: a job file to a machine.
#include <memory>

#include "host/cli/commands.hpp"
#include "host/cli/job_points.hpp"
#include "host/cli/run_job.hpp"
#include "host/job/job_file.hpp"

namespace lamplock::cli {
namespace {

struct Options {
  std::string file;
  BoardOptions board;
};

Exit send_file(const Options& options) {
  Console console(options.board.json);
  options.board.check();
  auto port = open_port(options.board);
  Work work{options.file, {}, job::read_job_file(options.file)};
  work.points = points_of(work.job);
  work.job.header.dry = work.job.header.dry || options.board.dry;
  take_off_fired(work, options.board);
  console.phase("job",
                fmt::format("{}: {} points, {}{}", options.file, work.points.size(),
                            mode_name(work.job.header.mode), work.job.header.dry ? ", dry" : ""));
  const Outcome outcome = run_job(work, options.board, std::move(port), console);
  return report_job(outcome, options.board, console);
}

}  // namespace

void add_send(CLI::App& program, Action& action) {
  CLI::App* app = program.add_subcommand("send", "Send a job file to a machine and see it through");
  app->footer(
      "Example:\n  lamplock send model.llj --board /dev/ttyACM0\n"
      "  lamplock send model.llj --board /dev/ttyACM0 --from 5120     # go on after a stop");
  const auto options = std::make_shared<Options>();
  app->add_option("FILE", options->file, "Job file")->required()->type_name("FILE.llj");
  options->board.add_board(*app);
  options->board.add_job(*app);
  app->callback([options, &action] { action = [options] { return send_file(*options); }; });
}

}  // namespace lamplock::cli
