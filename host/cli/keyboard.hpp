// Lines that somebody types while something runs.
//
// In:  stdin. Out: whole lines, without waiting longer than told. Who: steering, the console.
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace lamplock::cli {

/// Reads stdin piece by piece.
class Keyboard {
 public:
  /// All lines that have come, up to 64 KB, without their ends. Waits at most this time for the
  /// first one. The rest of an input that has ended without a line end is a line.
  std::vector<std::string> lines(std::chrono::milliseconds wait);
  /// Nothing will come any more.
  bool ended() const { return ended_; }

  /// Somebody sits there, and this program has the keyboard.
  static bool at_terminal();

 private:
  void read_waiting(std::chrono::milliseconds wait);
  void read();

  bool ended_ = false;
  std::string typed_{};  ///< a line that has not ended
};

}  // namespace lamplock::cli
