// The switches and the probe, debounced.
//
// In:  levels of the pins, the present time, which pins are active while low.
// Out: changes for Controller::input_changed(), and when each of them began.
// Who: watch() from the beat interrupt every 100 us, so that it is known to 100 us when a contact
//      was made: 10 cycles while nothing changes. The rest from the main loop with that masked,
//      every 1 ms at least. The e-stop's interrupt has stopped everything before; here the core is
//      told.
//
// All switches are contacts to ground with the pin's pull-up. A change to active counts when it has
// been quiet for 50 us; back, when it has been quiet for 20 ms (contacts bounce for 1 to 10 ms), of
// the probe and of AUX IN at once as well, for a move or a program may wait for that. It began with
// its first bounce, and where the machine was then has to be asked for as soon as that is seen:
// some milliseconds later nobody knows.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/machine/inputs.hpp"
#include "shared/boards/pico_pins.hpp"

namespace lamplock::rp2040 {

/// One switch.
class DebouncedInput {
 public:
  static constexpr std::uint32_t engage_us = 50;
  static constexpr std::uint32_t release_us = 20'000;

  /// The pin looks like this now.
  void look(bool active, std::uint32_t now_us) {
    if (active == level_) return;
    level_ = active;
    since_us_ = now_us;
    if (level_ == active_) return;
    if (!turning_) began_us_ = now_us;
    turning_ = true;
  }
  /// True if active() has changed: the pin has been quiet for long enough.
  bool settle(std::uint32_t now_us, bool slow_release) {
    const std::uint32_t quiet_us = now_us - since_us_;
    const std::uint32_t wanted_us = level_ || !slow_release ? engage_us : release_us;
    if (quiet_us < wanted_us) return false;
    turning_ = false;
    if (level_ == active_) return false;
    active_ = level_;
    return true;
  }
  /// Active at once: somebody has seen more than a look can.
  bool force() {
    level_ = true;
    const bool change = !active_;
    active_ = true;
    return change;
  }
  bool active() const { return active_; }
  /// It may change: the pin has left the level that counts, and has not been back for long.
  bool turning() const { return turning_; }
  /// When it left that for the first time.
  std::uint32_t began_us() const { return began_us_; }

 private:
  bool level_ = false;    ///< active, as the pin was seen last
  bool active_ = false;   ///< debounced
  bool turning_ = false;  ///< it has left the level that is active_
  std::uint32_t since_us_ = 0;
  std::uint32_t began_us_ = 0;
};

/// All switches of a map.
class Inputs {
 public:
  static constexpr std::size_t most = 7;  ///< e-stop, door, probe, three limits, that of programs

  [[gnu::cold]] explicit Inputs(boards::PinMap map) {
    using boards::Role;
    using machine::Input;
    add(map, Role::estop, Input::estop);
    add(map, Role::door, Input::door);
    add(map, Role::probe, Input::probe);
    add(map, Role::aux_in, Input::aux);
    add(map, Role::limits, Input::limit_chain);
    add(map, Role::limit_x, Input::limit_x);
    add(map, Role::limit_y, Input::limit_y);
    add(map, Role::limit_z, Input::limit_z);
  }

  /// Beat interrupt, or main loop with it masked.
  void watch(std::uint32_t levels, std::uint32_t now_us) {
    if (((levels ^ seen_) & pins_) == 0) return;
    seen_ = levels;
    look(now_us);
  }
  /// Which are active while low; the settings may change it.
  void set_active_low(machine::InputSet inputs) {
    if (inputs == active_low_) return;
    active_low_ = inputs;
    low_pins_ = 0;
    for (std::size_t i = 0; i < count_; ++i)
      if ((inputs & machine::set_of(switches_[i].meaning)) != 0)
        low_pins_ |= 1u << switches_[i].gpio;
  }
  /// `begins(i, began_us)` where switch i may be about to change, once; `changed(input, active, i)`
  /// when it has. `most` is no switch.
  template <class Begins, class Changed>
  void poll(std::uint32_t levels, std::uint32_t now_us, Begins&& begins, Changed&& changed) {
    seen_ = levels;
    look(now_us);
    for (std::size_t i = 0; i < count_; ++i) {
      Switch& s = switches_[i];
      if (s.input.turning() && !s.told) begins(i, s.input.began_us());
      s.told = s.input.turning();
      if (s.input.settle(now_us, !is_quick(s.meaning))) changed(s.meaning, s.input.active(), i);
    }
  }
  /// The e-stop's interrupt came: pressed, however short.
  template <class Changed>
  void estop_seen(Changed&& changed) {
    if (switches_[0].input.force()) changed(machine::Input::estop, true, most);
  }
  bool estop() const { return switches_[0].input.active(); }
  /// All of them want a pull-up.
  std::uint32_t pins() const { return pins_; }
  machine::InputSet all() const {
    unsigned set = 0;
    for (std::size_t i = 0; i < count_; ++i) set |= machine::set_of(switches_[i].meaning);
    return static_cast<machine::InputSet>(set);
  }

 private:
  struct Switch {
    std::uint8_t gpio = 0;
    machine::Input meaning = machine::Input::estop;
    DebouncedInput input;
    bool told = false;  ///< that it turns
  };
  void add(boards::PinMap map, boards::Role role, machine::Input meaning) {
    const auto gpio = boards::find_gpio(map, role);
    if (!gpio) return;
    switches_[count_++] = {*gpio, meaning, {}};
    pins_ |= 1u << *gpio;
  }
  /// A move or a program may wait for its release.
  static constexpr bool is_quick(machine::Input input) {
    return input == machine::Input::probe || input == machine::Input::aux;
  }
  void look(std::uint32_t now_us) {
    const std::uint32_t active = seen_ ^ low_pins_;
    for (std::size_t i = 0; i < count_; ++i)
      switches_[i].input.look((active >> switches_[i].gpio & 1) != 0, now_us);
  }

  std::array<Switch, most> switches_{};
  std::size_t count_ = 0;
  std::uint32_t pins_ = 0;
  std::uint32_t low_pins_ = 0;  ///< active while low
  std::uint32_t seen_ = 0;
  machine::InputSet active_low_ = 0;
};

}  // namespace lamplock::rp2040
