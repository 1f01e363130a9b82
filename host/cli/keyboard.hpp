// Lines that the user types while something runs.
//
// In:  stdin. Out: whole lines, after at most the given wait. Who: the console, for use cases.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "host/run/frontend.hpp"

namespace lamplock::cli {

/// Reads stdin piece by piece.
class Keyboard : public run::LineInput {
 public:
  /// All lines that have come, up to 64 KB, without their ends. Waits at most this time for the
  /// first one. The rest of an input that has ended without a line end is a line.
  std::vector<std::string> lines(std::chrono::milliseconds wait) override;
  /// No further line will come.
  bool ended() const override { return ended_; }
  bool is_typed() const override { return at_terminal(); }

  /// Stdin is a terminal, and this program is in its foreground.
  static bool at_terminal();

 private:
  void read_waiting(std::chrono::milliseconds wait);
  void read();

  bool ended_ = false;
  std::string typed_{};  ///< a line that has not ended
};

}  // namespace lamplock::cli
