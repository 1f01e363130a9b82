// The shield for Mr Beam machines on which grblHAL runs (docs/boards/mrbeam.md): as the generic
// board, but for E-STOP, PROBE and SENSOR. Pins: grblHAL, RP2040, its pin map for Mr Beam.
#pragma once

#include "shared/boards/rows/grblhal_pico.hpp"

namespace lamplock::boards {
namespace mrbeam_pins {

/// E-STOP has the pin of SENSOR.
inline constexpr auto pins = [] {
  std::array<PinUse, grblhal_pico_pins::pins.size() - 1> moved{};
  std::size_t count = 0;
  for (PinUse use : grblhal_pico_pins::pins) {
    if (use.role == Role::sensor) continue;
    if (use.role == Role::estop) use.gpio = 27;
    if (use.role == Role::probe) use.gpio = 19;
    moved[count++] = use;
  }
  return moved;
}();
inline constexpr std::array maps{MapRow{"mrbeam", pins}};
}  // namespace mrbeam_pins

inline constexpr BoardRow mrbeam = [] {
  BoardRow row = grblhal_pico;
  row.name = "mrbeam";
  row.image = "lamplock-mrbeam";
  row.first_map = PinMap{5};
  row.maps = mrbeam_pins::maps;
  return row;
}();
static_assert(is_sound(mrbeam));

}  // namespace lamplock::boards
