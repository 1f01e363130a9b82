// All boards that there is an image for: a line here for each file in shared/boards/rows.
//
// In:  the number of a pin map, the name of a board. Out: its row and pins.
// Who: the host and the simulators. The image has its own row only (shared/boards/this_board.hpp).
#pragma once

#include <array>

#include "shared/boards/board_row.hpp"
#include "shared/boards/rows/grblhal_pico.hpp"
#include "shared/boards/rows/mrbeam.hpp"
#include "shared/boards/rows/pico.hpp"
#include "shared/boards/rows/picobob.hpp"
#include "shared/boards/rows/skr_pico.hpp"

namespace lamplock::boards {

inline constexpr std::array all_boards{&pico, &picobob, &grblhal_pico, &mrbeam, &skr_pico};

/// The board of that name; null if there is none.
constexpr const BoardRow* find_board(std::string_view name) {
  for (const BoardRow* row : all_boards)
    if (row->name == name) return row;
  return nullptr;
}
/// The board with a map of that number; null if there is none.
constexpr const BoardRow* find_board(PinMap map) {
  for (const BoardRow* row : all_boards)
    if (row->has(map)) return row;
  return nullptr;
}
/// The pins of a map; those of a Pico if no board has it.
constexpr Pins pins(PinMap map) {
  const BoardRow* row = find_board(map);
  return (row == nullptr ? pico : *row).map(map).pins;
}

constexpr std::optional<std::uint8_t> find_gpio(PinMap map, Role role) {
  return find_gpio(pins(map), role);
}
constexpr int axes(PinMap map) { return axes(pins(map)); }
constexpr std::uint8_t channels(PinMap map) { return channels(pins(map)); }
constexpr std::uint8_t program_outputs(PinMap map) { return program_outputs(pins(map)); }
constexpr std::uint8_t axes_of_z_enable(PinMap map) { return axes_of_z_enable(pins(map)); }

namespace detail {
/// Each map has its own number, each board its own name.
constexpr bool are_apart() {
  for (std::size_t i = 0; i < all_boards.size(); ++i)
    for (std::size_t j = i + 1; j < all_boards.size(); ++j) {
      const BoardRow &one = *all_boards[i], &other = *all_boards[j];
      if (one.name == other.name || one.image == other.image) return false;
      if (one.has(other.first_map) || other.has(one.first_map)) return false;
    }
  return true;
}
static_assert(are_apart());
}  // namespace detail

}  // namespace lamplock::boards
