// A Pico wired as the generic board of grblHAL (docs/boards/grblhal-pico.md), and boards made for
// that pin map. Pins: grblHAL, RP2040, boards/generic_map.h; Q-SWITCH and LAMP SYNC are on pins of
// its auxiliary ports, LAMP TRIGGER, LASER GATE and SHOT ENABLE on its outputs 12 to 14.
#pragma once

#include "shared/boards/board_row.hpp"

namespace lamplock::boards {
namespace grblhal_pico_pins {
using enum Direction;

inline constexpr std::array pins{
    PinUse{Role::step_x, 2, output, false, "X STEP"},
    PinUse{Role::dir_x, 5, output, false, "X DIR"},
    PinUse{Role::step_y, 3, output, false, "Y STEP"},
    PinUse{Role::dir_y, 6, output, false, "Y DIR"},
    PinUse{Role::step_z, 4, output, false, "Z STEP"},
    PinUse{Role::dir_z, 7, output, false, "Z DIR"},
    PinUse{Role::drives_enable, 8, output, false, "DRIVES ENABLE"},
    PinUse{Role::limit_x, 9, input, false, "X LIMIT"},
    PinUse{Role::limit_y, 10, input, false, "Y LIMIT"},
    PinUse{Role::limit_z, 11, input, false, "Z LIMIT"},
    PinUse{Role::lamp_trigger, 12, output, true, "LAMP TRIGGER"},
    PinUse{Role::laser_gate, 13, output, true, "LASER GATE"},
    PinUse{Role::shot_enable, 14, output, true, "SHOT ENABLE"},
    PinUse{Role::laser_pwm, 15, output, true, "LASER PWM"},
    PinUse{Role::air, 16, output, false, "AIR"},
    PinUse{Role::aux_out, 17, output, false, "AUX OUT"},
    PinUse{Role::estop, 18, input, false, "E-STOP"},
    PinUse{Role::door, 21, input, false, "DOOR"},
    PinUse{Role::q_switch, 22, output, true, "Q-SWITCH"},
    PinUse{Role::tick_line, 25, output, false, "TICK"},
    PinUse{Role::lamp_sync, 26, input, false, "LAMP SYNC"},
    PinUse{Role::sensor, 27, input, false, "SENSOR"},
    PinUse{Role::probe, 28, input, false, "PROBE"},
};
inline constexpr std::array maps{MapRow{"grblhal-pico", pins}};
}  // namespace grblhal_pico_pins

inline constexpr BoardRow grblhal_pico{.name = "grblhal-pico",
                                       .image = "lamplock-grblhal-pico",
                                       .first_map = PinMap{4},
                                       .maps = grblhal_pico_pins::maps,
                                       .reserved = mask_of(23, 24, 29),
                                       .pulled_up = mask_of(8),
                                       .uses_e5_pin = true};
static_assert(is_sound(grblhal_pico));

}  // namespace lamplock::boards
