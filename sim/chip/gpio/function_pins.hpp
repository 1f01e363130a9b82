// The pins of one peripheral function: which signal of which block is on which pin.
//
// In:  levels and output enables by signal; the function select and the pads, from Gpio.
// Out: levels on all pins that a signal can be on; the level of an input signal.
// Who: UART, SPI, I2C, clocks, USB: blocks of which several pins carry the same signal, and of
//      which two share the function. They are called when one of their inputs or a connection has
//      changed.
//
// An input that is on several pins is the OR of them (RP2040 datasheet, 2.19.2).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/gpio/gpio.hpp"

namespace lamplock::sim::chip {

/// The tables of 2.19.2 as numbers of signals; no_signal: nothing is on this pin.
inline constexpr unsigned no_signal = ~0u;
/// 4 x UART: TX, RX, CTS, RTS.
constexpr unsigned uart_signal(unsigned gpio) { return (gpio + 4) / 8 % 2 * 4 + gpio % 4; }
/// 4 x SPI: RX, CSn, SCK, TX.
constexpr unsigned spi_signal(unsigned gpio) { return gpio / 8 % 2 * 4 + gpio % 4; }
/// 2 x I2C: SDA, SCL.
constexpr unsigned i2c_signal(unsigned gpio) { return gpio / 2 % 2 * 2 + gpio % 2; }
/// GPOUT0 to GPOUT3, then GPIN0, GPIN1.
constexpr unsigned clock_signal(unsigned gpio) {
  switch (gpio) {
    case 20:
      return 4;
    case 21:
      return 0;
    case 22:
      return 5;
    case 23:
    case 24:
    case 25:
      return gpio - 22;
    default:
      return no_signal;
  }
}
/// OVERCURR_DETECT, VBUS_DETECT, VBUS_EN.
constexpr unsigned usb_signal(unsigned gpio) { return gpio % 3; }

class FunctionPins final : private FunctionListener {
 public:
  /// Calls of a block that has signals here.
  class User {
   public:
    virtual ~User() = default;
    /// A sensed input or a connection has changed.
    virtual void pins_changed(Cycle at) = 0;
    /// A pin may become connected: outputs that were on no pin so far must be right at `at`.
    virtual void pins_connecting(Cycle at) { static_cast<void>(at); }
  };
  using SignalOf = unsigned (*)(unsigned gpio);

  FunctionPins(Gpio& gpio, PinFunction function, SignalOf signal_of);
  FunctionPins(const FunctionPins&) = delete;
  FunctionPins& operator=(const FunctionPins&) = delete;

  void listen(User& user) { users_.push_back(&user); }
  /// Reports changes of this signal.
  void sense(unsigned signal) { sensed_ |= pins_[signal]; }
  void put(unsigned signal, bool level, bool enable, Cycle at);
  /// Whether a pin has the signal.
  bool connected(unsigned signal) const { return (selected() & pins_[signal]) != 0; }
  /// Level of a signal before any synchroniser; low if it is on no pin.
  bool input(unsigned signal) const { return (gpio_.inputs() & selected() & pins_[signal]) != 0; }
  /// Whether a pad that has the signal is driven.
  bool driven(unsigned signal) const { return (gpio_.driven() & selected() & pins_[signal]) != 0; }
  /// Brings what drives the pins up to date.
  void bring_sources_up_to(Cycle at) { gpio_.catch_up(at); }

 private:
  static constexpr std::size_t signal_count = 8;

  void inputs_changed(Cycle at) override;
  void connections_changing(Cycle at) override;
  void connections_changed(Cycle at) override;
  void report(Cycle at);
  std::uint32_t selected() const { return gpio_.selected(function_); }

  Gpio& gpio_;
  PinFunction function_;
  std::vector<User*> users_;
  std::array<std::uint32_t, signal_count> pins_{};  ///< by signal
  std::uint32_t sensed_ = 0;
  std::uint32_t seen_ = 0, connections_seen_ = 0;
  std::uint32_t levels_ = 0, enables_ = 0;
};

}  // namespace lamplock::sim::chip
