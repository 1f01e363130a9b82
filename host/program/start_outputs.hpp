// The output of the user (M62 to M68) as lines that `send --from` leaves out have set it, and the
// words that restore it.
//
// In:  the actions of the lines that are left out. Out: M64, M65 or M68 for what has taken effect,
//      M62, M63 or M67 for what waits for the next motion. Who: SkippedLines.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/program/action.hpp"

namespace lamplock::program_run {

class StartOutputs {
 public:
  void pass(const program::Action& action);
  void add_lines(std::vector<std::string>& lines) const;

 private:
  std::optional<program::IoRequest> in_force_, waiting_;
};

}  // namespace lamplock::program_run
