// A Raspberry Pi Pico wired by hand (docs/wiring.md): three maps, glass (engraving inside glass),
// cut (cutting, plotting) and cut_io (the same with an output and an input of programs instead of
// the UART), from one list of roles. GPIO 23, 24 and 29 belong to the Pico itself.
#pragma once

#include "shared/boards/board_row.hpp"

namespace lamplock::boards {
namespace pico_pins {
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

inline constexpr auto glass = join(common, glass_only);
inline constexpr auto cut = join(common, join(cut_common, cut_only));
inline constexpr auto cut_io = join(common, join(cut_common, cut_io_only));
inline constexpr std::array maps{MapRow{"glass", glass}, MapRow{"cut", cut},
                                 MapRow{"cut_io", cut_io}};
}  // namespace pico_pins

inline constexpr BoardRow pico{.name = "pico",
                               .image = "lamplock-rp2040",
                               .first_map = PinMap::glass,
                               .maps = pico_pins::maps,
                               .reserved = mask_of(23, 24, 29)};
static_assert(is_sound(pico) && has_paired_axes(pico));

}  // namespace lamplock::boards
