// The switches: e-stop, door, limits, debounced.
//
// In:  levels of the pins, the present time.
// Out: changes for Controller::input_changed().
// Who: main loop, every 1 ms at least. The e-stop's interrupt has stopped everything before; here
//      the core is told.
//
// All switches are normally closed to ground with the pin's pull-up: high = pressed, open, engaged,
// or a broken wire. A change to the dangerous side counts when it was seen twice, 50 us apart at
// least; back, when it has been quiet for 20 ms (contacts bounce for 1 to 10 ms).
#pragma once

#include <array>
#include <cstdint>

#include "firmware/machine/controller.hpp"
#include "shared/boards/pico_pins.hpp"

namespace lamplock::rp2040 {

/// One switch.
class DebouncedInput {
 public:
  static constexpr std::uint32_t engage_us = 50;
  static constexpr std::uint32_t release_us = 20'000;

  /// Takes a sample; true if active() has changed.
  bool sample(bool level, std::uint32_t now_us) {
    if (level != level_) {
      level_ = level;
      since_us_ = now_us;
      return false;
    }
    if (level_ == active_ || now_us - since_us_ < (level_ ? engage_us : release_us)) return false;
    active_ = level_;
    return true;
  }
  /// Active at once: somebody has seen more than a sample can.
  bool force() {
    level_ = true;
    const bool change = !active_;
    active_ = true;
    return change;
  }
  bool active() const { return active_; }

 private:
  bool level_ = false;
  bool active_ = false;
  std::uint32_t since_us_ = 0;
};

/// All switches of a map.
class Inputs {
 public:
  static constexpr std::size_t most = 6;

  explicit Inputs(boards::PinMap map) {
    using boards::Role;
    using machine::Input;
    add(map, Role::estop, Input::estop);
    add(map, Role::door, Input::door);
    add(map, Role::limits, Input::limit_x);
    add(map, Role::limit_x, Input::limit_x);
    add(map, Role::limit_y, Input::limit_y);
    add(map, Role::limit_z, Input::limit_z);
  }

  /// Samples all; `changed(input, active)` for every change.
  template <class Changed>
  void poll(std::uint32_t levels, std::uint32_t now_us, Changed&& changed) {
    for (std::size_t i = 0; i < count_; ++i) {
      Switch& s = switches_[i];
      if (s.input.sample((levels >> s.gpio & 1) != 0, now_us)) changed(s.meaning, s.input.active());
    }
  }
  /// The e-stop's interrupt came: pressed, however short.
  template <class Changed>
  void estop_seen(Changed&& changed) {
    if (switches_[0].input.force()) changed(machine::Input::estop, true);
  }
  bool estop() const { return switches_[0].input.active(); }
  /// Pins that want a pull-up.
  std::uint32_t pins() const {
    std::uint32_t mask = 0;
    for (std::size_t i = 0; i < count_; ++i) mask |= 1u << switches_[i].gpio;
    return mask;
  }

 private:
  struct Switch {
    std::uint8_t gpio = 0;
    machine::Input meaning = machine::Input::estop;
    DebouncedInput input;
  };
  void add(boards::PinMap map, boards::Role role, machine::Input meaning) {
    const auto gpio = boards::find_gpio(map, role);
    if (gpio) switches_[count_++] = {*gpio, meaning, {}};
  }

  std::array<Switch, most> switches_{};
  std::size_t count_ = 0;
};

}  // namespace lamplock::rp2040
