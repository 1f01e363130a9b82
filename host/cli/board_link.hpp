// A board to talk to by lines, real or simulated, behind one transport.
//
// In:  the options of the board, settings for a simulated one. Out: an open port.
// Who: programs of G-code, `settings`, `console`.
#pragma once

#include <memory>

#include "host/cli/boards.hpp"
#include "host/cli/options.hpp"
#include "host/cli/steering.hpp"
#include "host/link/line_port.hpp"
#include "host/link/transport.hpp"

namespace lamplock::cli {

/// Opens a board and keeps it open.
class BoardLink {
 public:
  /// Throws Error: no_device (cannot be opened), bad_input (no such image, no such address).
  BoardLink(const BoardOptions& options, const settings::Values& stored);

  link::LinePort& port() { return *port_; }
  /// The board, if it is simulated.
  sim::Board* simulated() { return simulated_.board.get(); }
  /// Whose time it is while somebody thinks.
  Clocking clocking() const { return simulated_.board ? Clocking::lock_step : Clocking::wall; }

 private:
  SimulatedBoard simulated_;
  std::unique_ptr<link::Transport> transport_;
  std::unique_ptr<link::LinePort> port_;
};

}  // namespace lamplock::cli
