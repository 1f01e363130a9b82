// A script for the chip: a list of steps, one after the other.
//
// In:  the parser's reading of a text (docs/chip-script.md has the grammar).
// Out: plain data. Who: made by the parser, carried out by the runner.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "sim/chip/cpu/fault.hpp"
#include "sim/chip/gpio/gpio.hpp"
#include "sim/world/time.hpp"

namespace lamplock::sim::chip::script {

/// A length of time, in picoseconds or in cycles of clk_sys.
struct Span {
  std::int64_t amount = 0;
  bool cycles = false;
};

enum class EdgeKind : std::uint8_t { rise, fall, any };

/// Edges of a pin that a step looks for.
struct PinEdge {
  unsigned gpio = 0;
  EdgeKind kind = EdgeKind::any;
};

/// A serial port of the chip.
enum class Port : std::uint8_t { usb, uart0, uart1 };
inline constexpr std::size_t port_count = 3;

/// Sets the script's time, counted from power-up.
struct At {
  Picoseconds time = 0;
};
/// Advances the script's time.
struct After {
  Span span;
};
struct SetPin {
  unsigned gpio = 0;
  External level = External::floating;
};
/// A permanent wire between two pins.
struct Join {
  unsigned one = 0, other = 0;
};
/// Voltage at the converter from now on.
struct SetVoltage {
  unsigned input = 0;  ///< at GPIO 26 + this
  double volts = 0;
};
struct SetTemperature {
  double celsius = 0;
};
/// Pulses to `level` from now on, while the script continues.
struct Pulse {
  unsigned gpio = 0;
  bool level = true;
  Span width, period;
  std::uint64_t times = 1;  ///< 0: without end
};
struct Send {
  Port port = Port::usb;
  std::string text;
};
/// The image's serial port is found on the USB.
struct ExpectPort {
  Span limit;
};
struct ExpectText {
  Port port = Port::usb;
  std::string text;
  Span limit;
};
struct ExpectEdge {
  PinEdge edge;
  Span limit;
};
/// After each of `times` causes the first edge must come neither too early nor too late.
struct ExpectReaction {
  PinEdge edge;
  Span least, most;
  PinEdge cause;
  std::uint64_t times = 1;
};
struct ExpectCount {
  PinEdge edge;
  std::uint64_t least = 0, most = 0;
  Span window;
};
struct ExpectNever {
  unsigned gpio = 0;
  bool level = true;
  Span window;
};
struct ExpectLevel {
  unsigned gpio = 0;
  bool level = true;
};
/// Frequency of rising edges, averaged over the window.
struct ExpectFrequency {
  unsigned gpio = 0;
  double hz = 0;
  double tolerance = 0;  ///< share of hz
  Span window;
};
/// Such faults do not fail the run, whenever they happen.
struct Allow {
  FaultKind kind = FaultKind::hard_fault;
};
struct End {};

using Action = std::variant<At, After, SetPin, Join, SetVoltage, SetTemperature, Pulse, Send,
                            ExpectPort, ExpectText, ExpectEdge, ExpectReaction, ExpectCount,
                            ExpectNever, ExpectLevel, ExpectFrequency, Allow, End>;

/// One step.
struct Step {
  int line = 0;
  std::string text;        ///< as written, without the words before the expectation
  bool meanwhile = false;  ///< in parallel with the following steps
  Action action;
};

using Script = std::vector<Step>;

}  // namespace lamplock::sim::chip::script
