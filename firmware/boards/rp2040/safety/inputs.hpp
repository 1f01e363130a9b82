// The switches and the probe, debounced.
//
// In:  levels of the pins, the present time, which pins are active low.
// Out: changes for Controller::input_changed(), and the time when each began.
// Who: watch(): beat interrupt every 100 us, so that the time of a contact is known to 100 us: 10
//      cycles while nothing changes. The rest: main loop with that masked, at least every 1 ms. The
//      e-stop interrupt has already stopped everything; this class reports it to the core.
//
// All switches are contacts to ground with the pin's pull-up; after an inverter of the board the
// levels are opposite. A change to active counts when it has
// been quiet for 50 us; back, when it has been quiet for 20 ms (contacts bounce for 1 to 10 ms),
// for the probe and AUX IN after 50 us as well, since a move or a program may wait for it. A change
// begins with its first bounce, and the position at that time must be requested as soon as that is
// seen: it is available for only some milliseconds.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/machine/inputs/inputs.hpp"
#include "shared/boards/this_board.hpp"

namespace lamplock::rp2040 {

/// One switch.
class DebouncedInput {
 public:
  static constexpr std::uint32_t engage_us = 50;
  static constexpr std::uint32_t release_us = 20'000;

  /// The present state of the pin.
  void sample(bool active, std::uint32_t now_us) {
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
  /// Sets active at once: an interrupt has seen an edge that sample() may miss.
  bool force() {
    level_ = true;
    const bool change = !active_;
    active_ = true;
    return change;
  }
  bool active() const { return active_; }
  /// It may change: the pin has left the debounced level, and has not been back for long.
  bool turning() const { return turning_; }
  /// Time of the first such change.
  std::uint32_t began_us() const { return began_us_; }

 private:
  bool level_ = false;    ///< active, at the last look
  bool active_ = false;   ///< debounced
  bool turning_ = false;  ///< the pin has left the level of active_
  std::uint32_t since_us_ = 0;
  std::uint32_t began_us_ = 0;
};

/// All switches of a map.
class Inputs {
 public:
  static constexpr std::size_t max_inputs = 7;  ///< e-stop, door, probe, three limits, AUX IN

  [[gnu::cold]] explicit Inputs(boards::Pins map) {
    using boards::Role;
    using machine::Input;
    low_pins_ = inverted_ = boards::inverted_pins(map);
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
    sample(now_us);
  }
  /// Sets the inputs that are active low. Called in every round of the main loop, so the set is
  /// only computed, with divisions, after one of its two settings has changed.
  void set_active_low(const settings::Values& values) {
    using settings::Id;
    const std::int32_t limits = values.milli(Id::limit_invert),
                       probe = values.milli(Id::probe_invert);
    if (limits == limit_invert_milli_ && probe == probe_invert_milli_) return;
    limit_invert_milli_ = limits;
    probe_invert_milli_ = probe;
    const machine::InputSet inputs = machine::active_low(values);
    low_pins_ = inverted_;
    for (std::size_t i = 0; i < count_; ++i)
      if ((inputs & machine::set_of(switches_[i].meaning)) != 0)
        low_pins_ ^= 1u << switches_[i].gpio;
  }
  /// Calls `begins(i, began_us)` once when switch i may be about to change, and `changed(input,
  /// active, i)` when it has. `max_inputs` is no switch.
  template <class Begins, class Changed>
  void poll(std::uint32_t levels, std::uint32_t now_us, Begins&& begins, Changed&& changed) {
    seen_ = levels;
    sample(now_us);
    for (std::size_t i = 0; i < count_; ++i) {
      Switch& s = switches_[i];
      if (s.input.turning() && !s.reported) begins(i, s.input.began_us());
      s.reported = s.input.turning();
      if (s.input.settle(now_us, !is_quick(s.meaning))) changed(s.meaning, s.input.active(), i);
    }
  }
  /// The e-stop interrupt occurred: pressed, however short.
  template <class Changed>
  void estop_seen(Changed&& changed) {
    if (switches_[0].input.force()) changed(machine::Input::estop, true, max_inputs);
  }
  bool estop() const { return switches_[0].input.active(); }
  /// From now on the e-stop is pressed, whatever its pin says, or as the pin says.
  void hold_estop(bool held) { held_pins_ = held ? 1u << switches_[0].gpio : 0; }
  /// Those that need a pull-up, so that an open one is high.
  std::uint32_t pulled_up() const { return pins_ & ~inverted_; }
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
    bool reported = false;  ///< begins() was called
  };
  void add(boards::Pins map, boards::Role role, machine::Input meaning) {
    const auto gpio = boards::find_gpio(map, role);
    if (!gpio) return;
    switches_[count_++] = {*gpio, meaning, {}};
    pins_ |= 1u << *gpio;
  }
  /// A move or a program may wait for the release.
  static constexpr bool is_quick(machine::Input input) {
    return input == machine::Input::probe || input == machine::Input::aux;
  }
  void sample(std::uint32_t now_us) {
    const std::uint32_t active = (seen_ ^ low_pins_) | held_pins_;
    for (std::size_t i = 0; i < count_; ++i)
      switches_[i].input.sample((active >> switches_[i].gpio & 1) != 0, now_us);
  }

  std::array<Switch, max_inputs> switches_{};
  std::size_t count_ = 0;
  std::uint32_t pins_ = 0;
  std::uint32_t inverted_ = 0;   ///< pins behind inverters
  std::uint32_t low_pins_ = 0;   ///< pins that are active low
  std::uint32_t held_pins_ = 0;  ///< pins that count as active
  std::uint32_t seen_ = 0;
  std::int32_t limit_invert_milli_ = -1, probe_invert_milli_ = -1;  ///< of low_pins_; -1: not set
};

}  // namespace lamplock::rp2040
