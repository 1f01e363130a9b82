// SKR Pico V1.0 by BIGTREETECH (docs/boards/skr-pico.md): an RP2040 with four TMC2209 drives, made
// for 3D printers. Pins: its schematic; grblHAL, RP2040; Klipper, generic-bigtreetech-skr-pico.
// Limit of the current: derived from the datasheet of the drives in docs/boards/skr-pico.md.
// Buffers of the board drive the inputs of the limit switches and of the filament sensor, which is
// the e-stop here. The enables have pull-ups, and so have the inputs of the thermistors. There is
// no LAMP TRIGGER: the connector P5 has two pins only. GPIO 21 and 23 switch heaters.
#pragma once

#include "shared/boards/board_row.hpp"

namespace lamplock::boards {
namespace skr_pico_pins {
using enum Direction;

inline constexpr std::array pins{
    PinUse{Role::step_x, 11, output, false, "X STEP"},
    PinUse{Role::dir_x, 10, output, false, "X DIR"},
    PinUse{Role::step_y, 6, output, false, "Y STEP"},
    PinUse{Role::dir_y, 5, output, false, "Y DIR"},
    PinUse{Role::step_z, 19, output, false, "Z STEP"},
    PinUse{Role::dir_z, 28, output, false, "Z DIR"},
    PinUse{Role::step_a, 14, output, false, "A STEP"},
    PinUse{Role::dir_a, 13, output, false, "A DIR"},
    PinUse{Role::drives_enable, 12, output, false, "X ENABLE"},
    PinUse{Role::drives_enable_2, 7, output, false, "Y ENABLE"},
    PinUse{Role::drives_enable_3, 2, output, false, "Z ENABLE"},
    PinUse{Role::drives_enable_4, 15, output, false, "A ENABLE"},
    PinUse{Role::limit_x, 4, input, false, "X LIMIT"},
    PinUse{Role::limit_y, 3, input, false, "Y LIMIT"},
    PinUse{Role::limit_z, 25, input, false, "Z LIMIT"},
    PinUse{Role::estop, 16, input, false, "E-STOP"},
    PinUse{Role::door, 26, input, false, "DOOR"},
    PinUse{Role::aux_in, 27, input, false, "AUX IN"},
    PinUse{Role::lamp_sync, 22, input, false, "LAMP SYNC"},
    PinUse{Role::laser_gate, 0, output, true, "LASER GATE"},
    PinUse{Role::shot_enable, 1, output, true, "SHOT ENABLE"},
    PinUse{Role::laser_pwm, 20, output, true, "LASER PWM"},
    PinUse{Role::q_switch, 24, output, true, "Q-SWITCH"},
    PinUse{Role::air, 17, output, false, "AIR"},
    PinUse{Role::aux_out, 18, output, false, "AUX OUT"},
    PinUse{Role::tick_line, 29, output, false, "TICK"},
};
inline constexpr std::array maps{MapRow{"skr-pico", pins}};
}  // namespace skr_pico_pins

inline constexpr BoardRow skr_pico{
    .name = "skr-pico",
    .image = "lamplock-skr-pico",
    .first_map = PinMap{6},
    .maps = skr_pico_pins::maps,
    .reserved = mask_of(8, 9, 21, 23),
    .pulled_up = mask_of(2, 7, 12, 15, 26, 27),
    .driven = mask_of(3, 4, 16, 25),
    .uses_e5_pin = true,
    .drives =
        UartDrives{.tx = 8, .addresses = {0, 2, 1, 3}, .sense_mohm = 110, .max_current_ma = 1200}};
static_assert(is_sound(skr_pico));

}  // namespace lamplock::boards
