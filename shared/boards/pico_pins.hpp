// The role of each pin of a Raspberry Pi Pico: the one table for firmware, simulator and wiring
// page.
//
// In:  nothing.
// Out: three maps, glass (engraving inside glass), cut (cutting, plotting) and cut_io (the same
//      with an output and an input of programs instead of the UART), from one list of roles.
// Who: the image (drivers look up their roles), the chip simulator (connects the pads to its
//      world), the documentation of the wiring.
//
// Rules, checked at compile time: a pin has one role in a map; an output that can release energy
// has the same pin in every map, so that a wrong map never fires; STEP and DIR of an axis are
// neighbours; the lattice bits are in a row, as a PIO state machine requires; GPIO 15 has no
// essential role (the work-around for USB erratum E5 borrows it) and GPIO 23, 24 and 29 belong to
// the Pico itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace lamplock::boards {

/// Function of a pin.
enum class Role : std::uint8_t {
  step_x,
  dir_x,
  step_y,
  dir_y,
  step_z,
  dir_z,
  step_a,
  dir_a,
  lamp_sync,      ///< in: the lamp flashes
  q_switch,       ///< out, energy: releases the pulse
  lamp_trigger,   ///< out, lattice bit 0: the controller triggers the lamp
  laser_gate,     ///< out, energy, lattice bit 1: continuous laser permitted
  shot_enable,    ///< out, energy, lattice bit 2: in position, a shot may be fired (ARM)
  laser_pwm,      ///< out, energy: attenuator, or power of a continuous laser
  drives_enable,  ///< out, active low: an external pull-up disables undriven drives
  status_led,
  estop,      ///< in: normally closed to ground, high = pressed or wire broken
  door,       ///< in: normally closed to ground, high = open or wire broken
  probe,      ///< in
  tick_line,  ///< the tick lattice; on a Pico the LED
  limits,     ///< in: all limit switches in one chain, normally closed
  limit_x,
  limit_y,
  limit_z,
  photosensor_1,
  photosensor_2,
  photosensor_3,
  photosensor_4,
  shutter_1,
  shutter_2,
  shutter_3,
  shutter_4,
  uart_tx,
  uart_rx,
  uart_direction,
  air,       ///< out: air or mist (M7, M8)
  aux_out,   ///< out: for programs (M62 to M65, M67, M68)
  aux_in,    ///< in: for programs (M66); closed to ground = on
  z_enable,  ///< out, as drives_enable: the drives of Z and A
  count
};

/// How a pin is driven.
enum class Direction : std::uint8_t { input, output };

/// One pin of a map.
struct PinUse {
  Role role;
  std::uint8_t gpio;
  Direction direction;
  bool energy;  ///< can release energy: active high, external pull-down
  std::string_view name;
};

/// The maps, numbered as in the setting `pin_map` ($990).
enum class PinMap : std::uint8_t { glass = 0, cut = 1, cut_io = 2 };
inline constexpr std::array all_maps{PinMap::glass, PinMap::cut, PinMap::cut_io};

namespace detail {
using enum Direction;

/// Pins of every map.
inline constexpr std::array common{
    PinUse{Role::step_x, 0, output, false, "X STEP"},
    PinUse{Role::dir_x, 1, output, false, "X DIR"},
    PinUse{Role::step_y, 2, output, false, "Y STEP"},
    PinUse{Role::dir_y, 3, output, false, "Y DIR"},
    PinUse{Role::step_z, 4, output, false, "Z STEP"},
    PinUse{Role::dir_z, 5, output, false, "Z DIR"},
    PinUse{Role::lamp_sync, 8, input, false, "LAMP SYNC"},
    PinUse{Role::q_switch, 9, output, true, "Q-SWITCH"},
    PinUse{Role::lamp_trigger, 10, output, true, "LAMP TRIGGER"},
    PinUse{Role::laser_gate, 11, output, true, "LASER GATE"},
    PinUse{Role::shot_enable, 12, output, true, "SHOT ENABLE"},
    PinUse{Role::laser_pwm, 13, output, true, "LASER PWM"},
    PinUse{Role::drives_enable, 14, output, false, "DRIVES ENABLE"},
    PinUse{Role::status_led, 15, output, false, "STATUS"},
    PinUse{Role::estop, 20, input, false, "E-STOP"},
    PinUse{Role::door, 21, input, false, "DOOR"},
    PinUse{Role::probe, 22, input, false, "PROBE"},
    PinUse{Role::tick_line, 25, output, false, "TICK"},
};
inline constexpr std::array glass_only{
    PinUse{Role::photosensor_1, 6, input, false, "PHOTOSENSOR 1"},
    PinUse{Role::photosensor_2, 7, input, false, "PHOTOSENSOR 2"},
    PinUse{Role::shutter_1, 16, output, false, "SHUTTER 1"},
    PinUse{Role::shutter_2, 17, output, false, "SHUTTER 2"},
    PinUse{Role::shutter_3, 18, output, false, "SHUTTER 3"},
    PinUse{Role::shutter_4, 19, output, false, "SHUTTER 4"},
    PinUse{Role::limits, 26, input, false, "LIMIT CHAIN"},
    PinUse{Role::photosensor_3, 27, input, false, "PHOTOSENSOR 3"},
    PinUse{Role::photosensor_4, 28, input, false, "PHOTOSENSOR 4"},
};
/// Pins of both maps for cutting.
inline constexpr std::array cut_common{
    PinUse{Role::step_a, 6, output, false, "A STEP"},
    PinUse{Role::dir_a, 7, output, false, "A DIR"},
    PinUse{Role::air, 19, output, false, "AIR"},
    PinUse{Role::limit_x, 26, input, false, "X LIMIT"},
    PinUse{Role::limit_y, 27, input, false, "Y LIMIT"},
    PinUse{Role::limit_z, 28, input, false, "Z LIMIT"},
};
inline constexpr std::array cut_only{
    PinUse{Role::uart_tx, 16, output, false, "UART0 TX"},
    PinUse{Role::uart_rx, 17, input, false, "UART0 RX"},
    PinUse{Role::uart_direction, 18, output, false, "UART DIRECTION"},
};
inline constexpr std::array cut_io_only{
    PinUse{Role::aux_out, 16, output, false, "AUX OUT"},
    PinUse{Role::aux_in, 17, input, false, "AUX IN"},
    PinUse{Role::z_enable, 18, output, false, "Z ENABLE"},
};

template <std::size_t n, std::size_t m>
constexpr std::array<PinUse, n + m> join(const std::array<PinUse, n>& a,
                                         const std::array<PinUse, m>& b) {
  std::array<PinUse, n + m> all{};
  for (std::size_t i = 0; i < n; ++i) all[i] = a[i];
  for (std::size_t i = 0; i < m; ++i) all[n + i] = b[i];
  return all;
}
}  // namespace detail

inline constexpr auto glass_pins = detail::join(detail::common, detail::glass_only);
inline constexpr auto cut_pins =
    detail::join(detail::common, detail::join(detail::cut_common, detail::cut_only));
inline constexpr auto cut_io_pins =
    detail::join(detail::common, detail::join(detail::cut_common, detail::cut_io_only));
using PinTable = std::array<PinUse, glass_pins.size()>;

/// The pins of a map.
constexpr const PinTable& pins(PinMap map) {
  if (map == PinMap::glass) return glass_pins;
  return map == PinMap::cut ? cut_pins : cut_io_pins;
}

/// Pin of a role; nothing if the map has none.
constexpr std::optional<std::uint8_t> find_gpio(PinMap map, Role role) {
  for (const PinUse& use : pins(map))
    if (use.role == role) return use.gpio;
  return std::nullopt;
}

namespace detail {
/// Not defined: a call ends compilation and its name is the reason.
void this_role_is_not_in_every_map();
}  // namespace detail

/// Pin of a role that every map has, at compile time; other roles do not compile.
consteval std::uint8_t gpio(Role role) {
  for (const PinUse& use : detail::common)
    if (use.role == role) return use.gpio;
  detail::this_role_is_not_in_every_map();
  return 0;
}

/// Number of axes that a map has pins for.
constexpr int axes(PinMap map) { return find_gpio(map, Role::step_a) ? 4 : 3; }

/// A bit for each beam channel that a map has a shutter for; without shutters the one beam is
/// always open.
constexpr std::uint8_t channels(PinMap map) { return find_gpio(map, Role::shutter_1) ? 0xf : 1; }

/// Outputs that programs may switch.
constexpr std::uint8_t program_outputs(PinMap map) { return find_gpio(map, Role::aux_out) ? 1 : 0; }

/// Axes whose drives have a separate enable, Z ENABLE, a bit for each: Z, which may be vertical,
/// and A. All others use DRIVES ENABLE.
constexpr std::uint8_t axes_of_z_enable(PinMap map) {
  return find_gpio(map, Role::z_enable) ? 0b1100 : 0;
}

constexpr Role step_role(int axis) { return static_cast<Role>(2 * axis); }
constexpr Role dir_role(int axis) { return static_cast<Role>(2 * axis + 1); }
/// First pin of the fourth axis where a map has one.
inline constexpr std::uint8_t step_a_gpio = 6;

namespace detail {
constexpr bool clash_free(const PinTable& table) {
  std::uint32_t used = 0;
  for (const PinUse& use : table) {
    const bool of_the_pico = use.gpio == 23 || use.gpio == 24 || use.gpio >= 29;
    if (of_the_pico || (used >> use.gpio & 1) != 0) return false;
    used |= 1u << use.gpio;
    if (use.gpio == 15 && use.role != Role::status_led) return false;
  }
  return true;
}
constexpr bool roles_once(const PinTable& table) {
  for (std::size_t i = 0; i < table.size(); ++i)
    for (std::size_t j = i + 1; j < table.size(); ++j)
      if (table[i].role == table[j].role) return false;
  return true;
}
constexpr bool energy_alike(PinMap map, PinMap other) {
  for (const PinUse& use : pins(map)) {
    if (!use.energy) continue;
    if (use.direction != Direction::output || find_gpio(other, use.role) != use.gpio) return false;
  }
  return true;
}
constexpr bool energy_alike() {
  for (const PinMap map : all_maps)
    for (const PinMap other : all_maps)
      if (!energy_alike(map, other)) return false;
  return true;
}
constexpr bool axes_are_pairs(PinMap map) {
  for (int axis = 0; axis < 4; ++axis) {
    const auto step = find_gpio(map, step_role(axis));
    const auto dir = find_gpio(map, dir_role(axis));
    if (step.has_value() != dir.has_value() || (step && *dir != *step + 1)) return false;
  }
  return true;
}
constexpr bool sound(PinMap map) {
  return clash_free(pins(map)) && roles_once(pins(map)) && axes_are_pairs(map);
}
static_assert(glass_pins.size() == cut_pins.size() && cut_pins.size() == cut_io_pins.size());
static_assert(sound(PinMap::glass) && sound(PinMap::cut) && sound(PinMap::cut_io));
static_assert(energy_alike());
static_assert(gpio(Role::laser_gate) == gpio(Role::lamp_trigger) + 1 &&
              gpio(Role::shot_enable) == gpio(Role::lamp_trigger) + 2);
static_assert(find_gpio(PinMap::cut, Role::step_a) == step_a_gpio &&
              find_gpio(PinMap::cut_io, Role::step_a) == step_a_gpio);
}  // namespace detail

}  // namespace lamplock::boards
