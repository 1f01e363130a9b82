// Lines of the host computer (GPIO): which chips there are, and single lines as inputs and outputs.
//
// In:  requests by a line's name or its chip and number. Out: levels, edges with their time.
//      A chip that is unplugged is an ordinary event, told by a value; only asking for a line
//      throws.
// Who: the guard of a running job (guard.hpp), reset and boot lines (board_lines.hpp), the list of
//      lines. libgpiod stands behind it (host_lines.hpp); in tests a model.
//
// Levels are logical: active is what `active_low` makes of the pin.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lamplock::gpio {

/// The resistor inside the chip; `as_is` leaves it as it was found.
enum class Bias : std::uint8_t { as_is, none, pull_up, pull_down };

/// An open drain pulls down when its pin is low, and lets go when it is high.
enum class Drive : std::uint8_t { push_pull, open_drain };

/// A line that is wanted.
struct LineRequest {
  std::string place{};  ///< its name, as in "GPIO17"; or chip and number, as in "gpiochip0:17"
  bool active_low = false;
  Bias bias = Bias::as_is;         ///< of inputs
  Drive drive = Drive::push_pull;  ///< of outputs
};

/// A change of an input.
struct Event {
  bool active = false;             ///< from then on
  std::chrono::nanoseconds at{0};  ///< by the kernel's clock of lines
};

/// An input that is watched. Released with the object.
class Input {
 public:
  virtual ~Input() = default;
  /// The changes since the last call, in their order; waits up to `time` for the first. A chip that
  /// is gone has none.
  virtual std::vector<Event> events(std::chrono::microseconds time) = 0;
  /// The level now; nothing if the chip is gone.
  virtual std::optional<bool> active() = 0;
};

/// An output. Released with the object; whether the pin then keeps its level is the chip's
/// business.
class Output {
 public:
  virtual ~Output() = default;
  /// False if the chip is gone.
  virtual bool set(bool active) = 0;
};

/// What is known of a line without asking for it.
struct LineInfo {
  unsigned number = 0;  ///< on its chip
  std::string name{};   ///< empty if it has none
  std::string user{};   ///< who has it; empty if it is free
  bool output = false;
};

/// A chip with lines.
struct ChipInfo {
  std::string file{};   ///< "/dev/gpiochip0"
  std::string label{};  ///< of its driver
  std::vector<LineInfo> lines{};
  std::string problem{};  ///< why it cannot be opened, with the remedy; then nothing else is known
};

/// All lines of a computer.
class Lines {
 public:
  virtual ~Lines() = default;
  /// Every chip, by number.
  virtual std::vector<ChipInfo> chips() = 0;
  /// Asks for an input. Throws Error: no_device (no such chip, not permitted, in use), bad_input
  /// (no such line, a bias that the chip does not have).
  virtual std::unique_ptr<Input> input(const LineRequest& wanted) = 0;
  /// Asks for an output that is at once at this level. Throws as input().
  virtual std::unique_ptr<Output> output(const LineRequest& wanted, bool active) = 0;
};

}  // namespace lamplock::gpio
