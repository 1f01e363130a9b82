// A board that is moved by single lines, supervised by the lines of this computer.
//
// In:  the options of board and machine. Out: an open, supervised port; the caller polls the
//      supervisor in every round of its loop. Who: `console`, `jog`.
#pragma once

#include "host/run/board_link.hpp"
#include "host/run/board_options.hpp"
#include "host/run/machine_options.hpp"
#include "host/run/supervisor.hpp"

namespace lamplock::run {

/// A board, and the machine that a simulated one has.
struct BoardChoice {
  BoardOptions board;
  MachineOptions machine;
};

struct SupervisedBoard {
  /// Opens the board and waits until the inputs are quiet. Throws Error.
  explicit SupervisedBoard(const BoardChoice& choice)
      : link(choice.board, choice.machine.profile().settings),
        supervisor(choice.board, link.port().transport()) {
    supervisor.begin(gpio::LaserUse::motion);
  }

  BoardLink link;
  Supervisor supervisor;
};

}  // namespace lamplock::run
