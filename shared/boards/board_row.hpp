// What a board is for the firmware: one row, made of pin maps, and the checks that every row
// passes.
//
// In:  nothing.
// Out: roles of pins, the type of a row, its checks. The rows are in shared/boards/rows, a file for
//      each board; shared/boards/this_board.hpp is the row of the image that is compiled,
//      shared/boards/all_boards.hpp has all of them.
// Who: the image (drivers look up their roles), the chip simulator (connects the pads to its
//      world), the host (capabilities of a board), the documentation of the wiring.
//
// A pin map has a number of its own among those of all boards, the value of the setting `pin_map`
// ($990). A job must have the number of its board, so a job for another board is refused.
//
// Checked at compile time: a pin has one role in a map; an output that can release energy has the
// same pin in every map of a board, so that a wrong map never fires, is active high, and has
// neither a pull-up nor a buffer on it that drives the pin; buffers of the board drive inputs only;
// bits of the lattice and shutters are in a row, as PIO and one store require; LAMP TRIGGER, the
// first of the former, may be missing: such a board only follows a lamp; GPIO 15 has no
// essential role, unless the row does without the work-around for USB erratum E5, which borrows
// it; SENSOR is a pin of the ADC.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
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
  air,              ///< out: air or mist (M7, M8)
  aux_out,          ///< out: for programs (M62 to M65, M67, M68)
  aux_in,           ///< in: for programs (M66); closed to ground = on
  z_enable,         ///< out, as drives_enable: the drives of Z and A
  drives_enable_2,  ///< out, with drives_enable and like it: drives with an enable each
  drives_enable_3,
  drives_enable_4,
  sensor,  ///< in, analogue, 0 to 3.3 V: a temperature ($1061); a pin of the ADC
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
  bool inverted = false;  ///< an input behind an inverter of the board: low at the pad = active
};
/// The pins of a map.
using Pins = std::span<const PinUse>;

/// Number of a pin map among those of all boards: the setting `pin_map` ($990). Named are those of
/// a Pico wired by hand; other boards have one map each.
enum class PinMap : std::uint8_t { glass = 0, cut = 1, cut_io = 2 };

/// A pin map and its name in the documentation.
struct MapRow {
  std::string_view name;
  Pins pins;
};

/// A bit for each of these pins.
template <class... Gpios>
constexpr std::uint32_t mask_of(Gpios... gpios) {
  return (0u | ... | (1u << gpios));
}

/// Drives on the board, TMC2209, that the image sets up over a UART before it enables them.
struct UartDrives {
  std::uint8_t tx;                        ///< RX is the next pin
  std::array<std::uint8_t, 4> addresses;  ///< of X Y Z A, as the pins MS1 and MS2 are wired
  std::uint16_t sense_mohm;               ///< sense resistors
  std::uint16_t max_current_ma;           ///< effective value
};

/// A board that can be bought or wired. Levels and pulls are those at the pads of the RP2040.
struct BoardRow {
  std::string_view name;         ///< in `flash --for` and `$I`
  std::string_view image;        ///< name of the files with its image, without their endings
  PinMap first_map;              ///< number of maps[0]; the others follow
  std::span<const MapRow> maps;  ///< at least one
  std::uint32_t reserved;        ///< pads without a contact, or used by the board itself
  std::uint32_t pulled_up = 0;   ///< pads with a pull-up of the board
  std::uint32_t driven = 0;      ///< pads that buffers of the board drive
  /// GPIO 15 is in use: chips before B2 go without the work-around for erratum E5, so that they may
  /// not be found after a hub.
  bool uses_e5_pin = false;
  std::optional<UartDrives> drives{};  ///< none: drives outside, or set up by themselves

  constexpr bool has(PinMap map) const {
    return map >= first_map &&
           static_cast<std::size_t>(map) - static_cast<std::size_t>(first_map) < maps.size();
  }
  /// The map of that number, or the first one if the board has no such map.
  constexpr const MapRow& map(PinMap number) const {
    return maps[has(number) ? static_cast<std::size_t>(number) - static_cast<std::size_t>(first_map)
                            : 0];
  }
};

/// Pin of a role; nothing if the map has none.
constexpr std::optional<std::uint8_t> find_gpio(Pins pins, Role role) {
  for (const PinUse& use : pins)
    if (use.role == role) return use.gpio;
  return std::nullopt;
}
/// Pin of a role in the first map of the board that has one.
constexpr std::optional<std::uint8_t> find_gpio(const BoardRow& row, Role role) {
  for (const MapRow& map : row.maps)
    if (const auto gpio = find_gpio(map.pins, role)) return gpio;
  return std::nullopt;
}
/// The pin of a role as a bit; 0 if the map has none.
constexpr std::uint32_t pin_of(Pins pins, Role role) {
  const auto gpio = find_gpio(pins, role);
  return gpio ? 1u << *gpio : 0;
}
/// A bit for each pin that has one of these roles in any map of the board.
template <class... Roles>
constexpr std::uint32_t pins_of(const BoardRow& row, Roles... roles) {
  std::uint32_t pins = 0;
  for (const MapRow& map : row.maps)
    for (const Role role : {roles...}) pins |= pin_of(map.pins, role);
  return pins;
}
/// A bit for each inverted pin of the map.
constexpr std::uint32_t inverted_pins(Pins pins) {
  std::uint32_t inverted = 0;
  for (const PinUse& use : pins)
    if (use.inverted) inverted |= 1u << use.gpio;
  return inverted;
}

/// Input n of the ADC is this pin + n (RP2040 datasheet, 4.9).
inline constexpr std::uint8_t first_analog_gpio = 26;

/// Number of axes that a map has pins for.
constexpr int axes(Pins pins) { return find_gpio(pins, Role::step_a) ? 4 : 3; }

/// A bit for each beam channel that a map has a shutter for; without shutters the one beam is
/// always open.
constexpr std::uint8_t channels(Pins pins) { return find_gpio(pins, Role::shutter_1) ? 0xf : 1; }

constexpr bool is_enable(Role role) {
  return role == Role::drives_enable ||
         (role >= Role::drives_enable_2 && role <= Role::drives_enable_4);
}
/// All enables of drives that are switched together.
constexpr std::uint32_t enable_pins(const BoardRow& row) {
  return pins_of(row, Role::drives_enable, Role::drives_enable_2, Role::drives_enable_3,
                 Role::drives_enable_4);
}
/// The board knows that low levels enable its drives: they are on it, or it pulls their enable up.
constexpr bool enables_low(const BoardRow& row) {
  return row.drives || (row.pulled_up & enable_pins(row)) != 0;
}

/// Outputs that programs may switch.
constexpr std::uint8_t program_outputs(Pins pins) { return find_gpio(pins, Role::aux_out) ? 1 : 0; }

/// Axes whose drives have a separate enable, Z ENABLE, a bit for each: Z, which may be vertical,
/// and A. All others use DRIVES ENABLE.
constexpr std::uint8_t axes_of_z_enable(Pins pins) {
  return find_gpio(pins, Role::z_enable) ? 0b1100 : 0;
}

constexpr Role step_role(int axis) { return static_cast<Role>(2 * axis); }
constexpr Role dir_role(int axis) { return static_cast<Role>(2 * axis + 1); }

/// DIR of every axis is next to its STEP in every map: then the axis may also have CW and CCW or
/// quadrature, and needs a shorter program.
constexpr bool has_paired_axes(const BoardRow& row) {
  for (int axis = 0; axis < 4; ++axis) {
    const auto step = find_gpio(row, step_role(axis)), dir = find_gpio(row, dir_role(axis));
    if (step && *dir != *step + 1) return false;
  }
  return true;
}

namespace detail {
constexpr bool of_use(const BoardRow& row, const PinUse& use) {
  const std::uint32_t pin = 1u << use.gpio;
  if (use.gpio >= 30 || (row.reserved & pin) != 0) return false;
  if (use.gpio == 15 && use.role != Role::status_led && !row.uses_e5_pin) return false;
  if (use.role == Role::sensor && use.gpio < first_analog_gpio) return false;
  if (use.direction == Direction::input) return !use.energy;
  if (use.inverted || (row.driven & pin) != 0) return false;
  return !use.energy || (row.pulled_up & pin) == 0;
}
constexpr bool each_once(Pins pins) {
  for (std::size_t i = 0; i < pins.size(); ++i)
    for (std::size_t j = i + 1; j < pins.size(); ++j)
      if (pins[i].role == pins[j].role || pins[i].gpio == pins[j].gpio) return false;
  return true;
}
constexpr bool is_essential(Role role) {
  switch (role) {
    case Role::lamp_sync:
    case Role::q_switch:
    case Role::laser_gate:
    case Role::shot_enable:
    case Role::laser_pwm:
    case Role::estop:
    case Role::tick_line:
      return true;
    default:
      return role <= Role::dir_z;
  }
}
/// Roles that every map has if one map does.
constexpr bool is_of_all_maps(Role role) {
  return role == Role::lamp_trigger || role == Role::status_led || is_enable(role);
}
/// Essential roles have a pin in every map, the same one.
constexpr bool fixed_alike(const BoardRow& row) {
  for (int i = 0; i < static_cast<int>(Role::count); ++i) {
    const auto role = static_cast<Role>(i);
    if (!is_essential(role) && !is_of_all_maps(role)) continue;
    const auto gpio = find_gpio(row, role);
    if (is_essential(role) && !gpio) return false;
    for (const MapRow& map : row.maps)
      if (find_gpio(map.pins, role) != gpio) return false;
  }
  return true;
}
/// In every map where there are any: as many pins in a row as roles, from that of `first` on.
constexpr bool in_a_row(const BoardRow& row, Role first, int count) {
  for (const MapRow& map : row.maps) {
    const auto begin = find_gpio(map.pins, first);
    for (int i = 1; i < count; ++i) {
      const auto gpio = find_gpio(map.pins, static_cast<Role>(static_cast<int>(first) + i));
      if (gpio.has_value() != begin.has_value() || (gpio && *gpio != *begin + i)) return false;
    }
  }
  return true;
}
/// GATE and SHOT ENABLE follow LAMP TRIGGER, which may be missing.
constexpr bool lattice_in_a_row(const BoardRow& row) {
  const unsigned gate = *find_gpio(row, Role::laser_gate);
  const auto trigger = find_gpio(row, Role::lamp_trigger);
  return *find_gpio(row, Role::shot_enable) == gate + 1 && (!trigger || *trigger + 1u == gate);
}
/// Pins that a role other than STEP and DIR of Z may have in one map of the board only.
constexpr bool optional_alike(const BoardRow& row) {
  for (const MapRow& map : row.maps)
    for (const PinUse& use : map.pins)
      if (find_gpio(row, use.role) != use.gpio) return false;
  return true;
}
constexpr bool axes_complete(const BoardRow& row) {
  for (const MapRow& map : row.maps)
    if (find_gpio(map.pins, Role::step_a).has_value() !=
        find_gpio(map.pins, Role::dir_a).has_value())
      return false;
  return true;
}
/// The link: UART0 (RP2040 datasheet, 2.19.2); the drives have UART1.
constexpr bool uart_reaches(const BoardRow& row) {
  const auto tx = find_gpio(row, Role::uart_tx), rx = find_gpio(row, Role::uart_rx);
  if (!tx && !rx) return true;
  return tx && rx && (*tx == 0 || *tx == 12 || *tx == 16 || *tx == 28) && *rx == *tx + 1;
}
/// The UART of the drives is not in the maps, nor that of the link.
constexpr bool drives_reachable(const BoardRow& row) {
  if (!row.drives) return true;
  const unsigned tx = row.drives->tx;
  return tx % 4 == 0 && (tx + 4) / 8 % 2 == 1 && (row.reserved >> tx & 3) == 3;
}
constexpr unsigned slice_of(unsigned gpio) { return gpio / 2 % 8; }
}  // namespace detail

/// The rules at the top of this file.
constexpr bool is_sound(const BoardRow& row) {
  if (row.maps.empty() || row.name.empty()) return false;
  for (const MapRow& map : row.maps) {
    if (!detail::each_once(map.pins)) return false;
    for (const PinUse& use : map.pins)
      if (!detail::of_use(row, use)) return false;
  }
  if (!detail::fixed_alike(row) || !detail::optional_alike(row) || !detail::axes_complete(row))
    return false;
  if (!detail::lattice_in_a_row(row) || !detail::in_a_row(row, Role::shutter_1, 4)) return false;
  if (!detail::uart_reaches(row) || !detail::drives_reachable(row)) return false;
  const auto aux = find_gpio(row, Role::aux_out);
  return !aux || detail::slice_of(*aux) != detail::slice_of(*find_gpio(row, Role::laser_pwm));
}

}  // namespace lamplock::boards
