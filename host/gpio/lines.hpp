// Lines of the host computer (GPIO): a list of chips, and single lines as inputs and outputs.
//
// In:  requests by a line's name or its chip and number. Out: levels and edges. An unplugged chip
//      is an ordinary event, reported by a value; only a request for a line throws.
// Who: inputs and outputs of a job (safety_inputs.hpp), reset and boot lines (board_lines.hpp), the
//      list of lines. Implemented with libgpiod (host_lines.hpp); in tests by a model.
//
// Levels are logical: active or not, after `active_low`.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lamplock::gpio {

/// The resistor inside the chip; `as_is` keeps its current state. On a chip without resistors the
/// kernel ignores the request and reports success (gpio_set_bias() in drivers/gpio/gpiolib.c). A
/// broken wire is detected only with a resistor.
enum class Bias : std::uint8_t { as_is, none, pull_up, pull_down };

/// An open drain pulls its pin low, and is off when the pin is high.
enum class Drive : std::uint8_t { push_pull, open_drain };

/// A request for a line.
struct LineRequest {
  std::string place{};  ///< its name, as in "GPIO17"; or chip and number, as in "gpiochip0:17"
  bool active_low = false;
  Bias bias = Bias::as_is;         ///< of inputs
  Drive drive = Drive::push_pull;  ///< of outputs
};

/// An input line. Released with the object.
class Input {
 public:
  virtual ~Input() = default;
  /// There were edges since the last call, in either direction. Always false on a chip without
  /// interrupts (FT232H, MCP2221), where pulses between two reads of the level are missed, and on
  /// an unplugged chip.
  virtual bool moved() = 0;
  /// The present level; empty if the chip is unplugged.
  virtual std::optional<bool> active() = 0;
};

/// An output line. Released with the object; the chip determines the level after that.
class Output {
 public:
  virtual ~Output() = default;
  /// False if the chip is unplugged.
  virtual bool set(bool active) = 0;
};

/// Properties of a line that can be read without a request.
struct LineInfo {
  unsigned number = 0;  ///< on its chip
  std::string name{};   ///< empty if it has none
  std::string user{};   ///< program or driver that uses it; empty if it is free
  bool output = false;
};

/// A chip with lines.
struct ChipInfo {
  std::string file{};   ///< "/dev/gpiochip0"
  std::string label{};  ///< of its driver
  std::vector<LineInfo> lines{};
  std::string problem{};  ///< why it cannot be opened, with the remedy; label and lines are empty
};

/// All lines of a computer.
class Lines {
 public:
  virtual ~Lines() = default;
  /// Every chip, by number.
  virtual std::vector<ChipInfo> chips() = 0;
  /// Requests an input, with edges if the chip has them. Throws Error: no_device (no such chip, not
  /// permitted, in use), bad_input (no such line, a property that the chip refuses).
  virtual std::unique_ptr<Input> input(const LineRequest& wanted) = 0;
  /// Requests an output with this initial level. Throws as input().
  virtual std::unique_ptr<Output> output(const LineRequest& wanted, bool active) = 0;
};

}  // namespace lamplock::gpio
