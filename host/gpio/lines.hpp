// Lines of the host computer (GPIO): which chips there are, and single lines as inputs and outputs.
//
// In:  requests by a line's name or its chip and number. Out: levels, and whether they have moved.
//      A chip that is unplugged is an ordinary event, told by a value; only asking for a line
//      throws.
// Who: the guard of a running job (guard.hpp), reset and boot lines (board_lines.hpp), the list of
//      lines. libgpiod stands behind it (host_lines.hpp); in tests a model.
//
// Levels are logical: active is what `active_low` makes of the pin.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lamplock::gpio {

/// The resistor inside the chip; `as_is` leaves it as it was found. A chip that has none is asked
/// in vain and nobody is told: the kernel takes that for success (gpio_set_bias() in
/// drivers/gpio/gpiolib.c). A broken wire is seen only with a resistor that is there.
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

/// An input that is watched. Released with the object.
class Input {
 public:
  virtual ~Input() = default;
  /// There were edges since the last call, in whatever direction. Never on a chip that cannot be
  /// woken by its pins (FT232H, MCP2221): what comes and goes between two looks at the level of
  /// such a one is not seen. Nor on a chip that is gone.
  virtual bool moved() = 0;
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
  /// Asks for an input, with edges where the chip has them. Throws Error: no_device (no such chip,
  /// not permitted, in use), bad_input (no such line, something that the chip refuses).
  virtual std::unique_ptr<Input> input(const LineRequest& wanted) = 0;
  /// Asks for an output that is at once at this level. Throws as input().
  virtual std::unique_ptr<Output> output(const LineRequest& wanted, bool active) = 0;
};

}  // namespace lamplock::gpio
