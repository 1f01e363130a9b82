#include "host/run/board_link.hpp"

#include "host/link/dialog.hpp"
#include "host/link/simulated_transport.hpp"
#include "host/run/board_port.hpp"
#include "sim/world/limit_settings.hpp"
#include "sim/world/world.hpp"

namespace lamplock::run {

BoardLink::BoardLink(const BoardOptions& options, const settings::Values& stored)
    : transport_(open_port(options)) {
  check_image(options.board, options.image);
  if (!transport_) {
    sim::WorldConfig world;
    world.lamp = options.faults.lamp(stored);
    world.drives = options.drives.drives(stored);
    world.switches = sim::limits_of(stored);
    world.heat = options.spot.heat(stored);
    simulated_ = make_board(options.board, options.image, stored, world, options.usb_function());
    transport_ = std::make_unique<link::SimulatedTransport>(*simulated_.board);
  }
  port_ = std::make_unique<link::LinePort>(*transport_);
}

void BoardLink::unlock_simulated() {
  if (simulated_.board) link::unlock(*port_);
}

}  // namespace lamplock::run
