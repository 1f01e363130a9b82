// A board that is moved by single lines, under the eyes of the lines of this computer.
//
// In:  the options of board and machine. Out: an open port, watched; the caller looks at the
//      guarding in every round of its loop. Who: `console`, `jog`.
#pragma once

#include "host/cli/board_link.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/guarding.hpp"
#include "host/cli/options.hpp"

namespace lamplock::cli {

/// Which board, and what a simulated one is like.
struct BoardChoice {
  BoardOptions board;
  MachineOptions machine;

  void add(Command& app) {
    board.add_choice(app);
    machine.add_machine(app);
  }
};

struct GuardedBoard {
  /// Opens the board and waits until the inputs are quiet. Throws Error.
  explicit GuardedBoard(const BoardChoice& choice)
      : link(choice.board, choice.machine.profile().settings),
        guarding(choice.board, link.port().transport()) {
    guarding.begin(gpio::Work::motion);
  }

  BoardLink link;
  Guarding guarding;
};

}  // namespace lamplock::cli
