// The switches of the machine, and the level of a pin at which each is active.
//
// In:  the levels that a board reads at its pins.
// Out: sets of active inputs, one bit each.
// Who: boards, before they report to the core (Controller::input_changed()); the core.
//
// Every switch is a contact to ground with a pull-up at the pin. E-stop, door and limit switches
// are normally closed: high = pressed, open, engaged, or a broken wire. A probe closes its circuit
// when it touches: low. $5 and $6 invert limits and probe; e-stop and door cannot be inverted.
#pragma once

#include <cstdint>

#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::machine {

/// Switches the board reports; active = pressed, open, engaged, touching.
enum class Input : std::uint8_t {
  estop,
  door,
  probe,
  limit_x,
  limit_y,
  limit_z,
  limit_a,
  aux,          ///< for programs (M66); active = closed to ground
  limit_chain,  ///< the limits of all axes in one circuit: the axis is not known
  count
};

/// A bit for each input.
using InputSet = std::uint16_t;
inline constexpr InputSet all_inputs = (1u << static_cast<unsigned>(Input::count)) - 1;
constexpr InputSet set_of(Input input) {
  return static_cast<InputSet>(1u << static_cast<unsigned>(input));
}
constexpr Input limit_of(int axis) {
  return static_cast<Input>(static_cast<int>(Input::limit_x) + axis);
}
inline constexpr InputSet limit_inputs = set_of(Input::limit_x) | set_of(Input::limit_y) |
                                         set_of(Input::limit_z) | set_of(Input::limit_a) |
                                         set_of(Input::limit_chain);
constexpr bool is_limit(Input input) { return (set_of(input) & limit_inputs) != 0; }

/// Axes with an engaged limit, a bit for each; with a chain: all.
constexpr std::uint8_t engaged_axes(InputSet active) {
  constexpr std::uint8_t every_axis = (1u << max_axes) - 1;
  if ((active & set_of(Input::limit_chain)) != 0) return every_axis;
  return static_cast<std::uint8_t>(active >> static_cast<unsigned>(Input::limit_x) & every_axis);
}

/// Inputs that are active while their pin is low. A chain uses the bit of X in $5.
constexpr InputSet active_low(const settings::Values& values) {
  using settings::Id;
  const auto limits = static_cast<unsigned>(values.whole(Id::limit_invert));
  InputSet low = values.whole(Id::probe_invert) == 0 ? set_of(Input::probe) : InputSet{0};
  low = static_cast<InputSet>(low | set_of(Input::aux));
  for (int a = 0; a < max_axes; ++a)
    if ((limits >> a & 1u) != 0) low = static_cast<InputSet>(low | set_of(limit_of(a)));
  if ((limits & 1u) != 0) low = static_cast<InputSet>(low | set_of(Input::limit_chain));
  return low;
}

}  // namespace lamplock::machine
