// What the lines of a program have switched, line by line.
//
// In:  the lines in the order in which a board executes them, its settings and its state before
//      them. Out: laser or spindle, S, air, AUX OUT as programmed by the lines so far.
// Who: the stream of executed blocks (host/run/program_events.hpp). A board reports neither AUX OUT
//      nor which line has switched an output, so the interpreter of the firmware runs the lines.
#pragma once

#include <string_view>

#include "firmware/machine/activities/program_reader.hpp"
#include "firmware/program/interpreter.hpp"
#include "host/program/board_state.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::program_run {

class BlockOutputs {
 public:
  /// `state`: of the board before the first line, null if unknown.
  BlockOutputs(const settings::Values& values, const BoardState* state);

  /// The next line that was executed.
  void run(std::string_view line);

  program::Spindle spindle() const { return interpreter_.modal().spindle; }
  double speed_s() const;  ///< S word in force
  bool mist() const { return interpreter_.modal().mist; }
  bool flood() const { return interpreter_.modal().flood; }
  double aux() const { return aux_; }  ///< 0 to 1: M62 to M65, M67, M68

 private:
  program::Parameters parameters_;
  const program::Options options_;
  program::Interpreter interpreter_{parameters_, options_};
  double aux_ = 0;
};

}  // namespace lamplock::program_run
