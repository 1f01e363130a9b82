#include "host/run/operate.hpp"

#include <cmath>
#include <utility>

#include "host/link/board_settings.hpp"
#include "host/link/kept_job.hpp"
#include "host/link/transport.hpp"
#include "host/run/before_firing.hpp"
#include "host/run/board_files.hpp"
#include "host/run/board_link.hpp"
#include "host/run/board_port.hpp"
#include "host/run/permission.hpp"
#include "host/run/prepared_job.hpp"
#include "host/run/run_job.hpp"
#include "host/run/supervisor.hpp"

namespace lamplock::run {
namespace {

using link::Operation;
using link::Places;

/// A job of one point: at the machine's position, by the machine's own settings.
PreparedJob pulse_job(link::LinePort& port, const OperateOptions& options) {
  link::require_ready(port, Operation::init);
  job::Profile profile;
  profile.settings = link::read_settings(port).values;
  const std::vector<double> at = link::ask_places(port).machine;
  const auto axis = [&at](std::size_t a) { return a < at.size() ? at[a] : 0; };
  job::JobOptions job;
  job.dry = options.board.dry;
  job.shots = static_cast<std::uint8_t>(options.flashes);
  job.channel = static_cast<std::uint8_t>(options.channel);
  job.energy = static_cast<std::uint16_t>(options.energy);
  PreparedJob prepared{"test pulse", {{axis(0), axis(1), axis(2)}}, {}};
  prepared.job = job::make_job(prepared.points, profile, job);
  // Points have three axes; a fourth one stays where it is.
  const PerAxis<double> scale = steps_per_mm(profile.settings);
  for (std::size_t a = 3; a < max_axes; ++a)
    prepared.job.targets.front().steps[a] =
        static_cast<std::int32_t>(std::lround(axis(a) * scale[a]));
  return prepared;
}

}  // namespace

Places operate(const OperateOptions& options, Operation operation, Frontend& frontend) {
  BoardLink board(options.board, options.machine.profile().settings);
  if (operation != Operation::home) board.unlock_simulated();
  before_firing([&] { link::require_ready(board.port(), operation); });
  // A machine in alarm does not report all of its places.
  const Places before = operation == Operation::home
                            ? Places{}
                            : before_firing([&] { return link::ask_places(board.port()); });
  const auto lines = before_firing([&] { return link::lines_of(operation, before, options.axes); });
  {
    const std::unique_ptr<Interrupts> interrupts = frontend.interrupts();
    Supervisor supervisor(options.board, board.port().transport());
    before_firing([&] { supervisor.begin(gpio::LaserUse::motion); });
    link::run_lines(board.port(), lines, [&] {
      supervisor.poll(board.port());
      return interrupts->count() > 0;
    });
  }
  return link::ask_places(board.port());
}

Places ask_places(const OperateOptions& options) {
  BoardLink board(options.board, options.machine.profile().settings);
  return before_firing([&] { return link::ask_places(board.port()); });
}

JobOutcome fire_test_flashes(const OperateOptions& options, Frontend& frontend) {
  options.board.check();
  require_askable(options.board, frontend);
  auto transport = open_port(options.board);
  PreparedJob prepared;
  if (transport) {
    link::LinePort port(*transport);
    prepared = before_firing([&] { return pulse_job(port, options); });
  } else {
    BoardLink board(options.board, options.machine.profile().settings);
    board.unlock_simulated();
    prepared = before_firing([&] { return pulse_job(board.port(), options); });
  }
  return run_job(prepared, options.board, std::move(transport), frontend);
}

}  // namespace lamplock::run
