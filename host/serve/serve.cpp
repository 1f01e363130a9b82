#include "host/serve/serve.hpp"

#include <filesystem>
#include <memory>
#include <utility>

#include "host/run/board_port.hpp"
#include "host/serve/access.hpp"
#include "host/serve/machine.hpp"
#include "host/serve/paced_transport.hpp"
#include "host/serve/server.hpp"
#include "sim/world/limit_settings.hpp"
#include "sim/world/world.hpp"

namespace lamplock::serve {
namespace {

using namespace std::chrono_literals;

/// Clients get what differs in this interval.
constexpr auto tick_interval = 50ms;

BoardOpener opener_of(const ServeOptions& options) {
  const run::BoardOptions& board = options.board;
  if (!board.is_simulated()) return [board] { return run::open_port(board); };
  const settings::Values values = options.machine.profile().settings;
  return [board, values]() -> std::unique_ptr<link::Transport> {
    sim::WorldConfig world;
    world.lamp = board.faults.lamp(values);
    world.drives = board.drives.drives(values);
    world.switches = sim::limits_of(values);
    return std::make_unique<PacedTransport>(
        run::make_board(board.board, board.image, values, world, board.usb_function()));
  };
}

/// The first connection is made here: an error of it ends the program with its message.
BoardOpener opened_once(const BoardOpener& open) {
  const auto first = std::make_shared<std::unique_ptr<link::Transport>>(open());
  return [open, first] { return *first ? std::exchange(*first, nullptr) : open(); };
}

}  // namespace

void serve(const ServeOptions& options, run::Frontend& frontend) {
  options.board.check();
  options.board.line_table();
  run::check_image(options.board.board, options.board.image);
  SiteOptions site;
  site.board = options.board.board;
  site.is_simulated = options.board.is_simulated();
  site.token = random_token();
  if (options.pairs) site.code = random_code();
  site.machine = options.machine;
  const JobFolder folder(options.folder.empty() ? default_job_folder()
                                                : std::filesystem::path(options.folder));
  const BoardOpener open = opened_once(opener_of(options));
  Server server(site, folder);
  WebServer web(loopback_address, static_cast<std::uint16_t>(options.port), server);
  Machine machine(open, options.board, options.machine);
  server.use(web, machine);
  frontend.say("page: http://{}:{}/#token={}", loopback_address, web.port(), site.token);
  if (options.pairs) frontend.say("code for pairing: {}", site.code);
  const auto interrupts = frontend.interrupts();
  web.run(tick_interval, [&] {
    server.tick();
    if (interrupts->count() > 0) web.stop();
  });
  server.end();
}

}  // namespace lamplock::serve
