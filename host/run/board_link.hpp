// A dialogue by lines with a board, real or simulated, over one transport.
//
// In:  the options of the board, settings for a simulated one. Out: an open port.
// Who: programs of G-code, `settings`, `console`.
#pragma once

#include <memory>

#include "host/link/line_port.hpp"
#include "host/link/transport.hpp"
#include "host/run/board_options.hpp"
#include "host/run/point_job_control.hpp"
#include "host/run/simulated_boards.hpp"

namespace lamplock::run {

/// Opens a board and keeps it open.
class BoardLink {
 public:
  /// Throws Error: no_device (cannot be opened), bad_input (no such image, no such address).
  BoardLink(const BoardOptions& options, const settings::Values& stored);

  link::LinePort& port() { return *port_; }
  /// The board, if it is simulated.
  sim::Board* simulated() { return simulated_.board.get(); }
  /// A simulated board of a machine that homes is locked at its power-up, as a real one is: unlocks
  /// it for a command that no other command can precede. No effect on a real board.
  void unlock_simulated();
  /// Whose time passes while the user thinks.
  Clocking clocking() const { return simulated_.board ? Clocking::lock_step : Clocking::wall; }

 private:
  SimulatedBoard simulated_;
  std::unique_ptr<link::Transport> transport_;
  std::unique_ptr<link::LinePort> port_;
};

}  // namespace lamplock::run
