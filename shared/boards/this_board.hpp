// The row of the board that this image is for.
//
// In:  LAMPLOCK_BOARD, the name of the row, and LAMPLOCK_BOARD_ROW, its file, from the build
//      (toolchain/arm/CMakeLists.txt). Tests on the host that use code of the image have those of a
//      Pico.
// Out: the row, and the pins that every map of the board has.
// Who: the image. Few files, since the build compiles each of them for each board.
#pragma once

#include "shared/boards/board_row.hpp"

#ifndef LAMPLOCK_BOARD
#define LAMPLOCK_BOARD pico
#define LAMPLOCK_BOARD_ROW "shared/boards/rows/pico.hpp"
#endif
#include LAMPLOCK_BOARD_ROW

namespace lamplock::boards {

inline constexpr const BoardRow& this_board = LAMPLOCK_BOARD;

namespace detail {
/// Not defined: a call ends compilation and its name is the reason.
void this_role_is_not_in_every_map();
}  // namespace detail

/// Pin of a role that every map of this board has, at compile time; other roles do not compile.
consteval std::uint8_t gpio(Role role) {
  const auto gpio = find_gpio(this_board, role);
  for (const MapRow& map : this_board.maps)
    if (!gpio || find_gpio(map.pins, role) != gpio) detail::this_role_is_not_in_every_map();
  return *gpio;
}
/// The pin of an input of every map is behind an inverter.
consteval bool is_inverted(Role role) {
  return (inverted_pins(this_board.maps[0].pins) >> gpio(role) & 1) != 0;
}
/// A map of this board has such a pin.
consteval bool has(Role role) { return find_gpio(this_board, role).has_value(); }
/// Pin of a role in the maps that have it; 0 on a board without one, where no code uses it.
consteval std::uint8_t optional_gpio(Role role) { return find_gpio(this_board, role).value_or(0); }
/// A bit for each pin of these roles in any map of this board; 0 without one.
template <class... Roles>
consteval std::uint32_t any_of(Roles... roles) {
  return pins_of(this_board, roles...);
}

}  // namespace lamplock::boards
