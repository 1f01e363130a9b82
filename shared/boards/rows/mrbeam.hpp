// The shield for Mr Beam machines on which grblHAL runs (docs/boards/mrbeam.md): as the generic
// board, but for E-STOP and PROBE. Pins: grblHAL, RP2040, its pin map for Mr Beam.
#pragma once

#include "shared/boards/board_row.hpp"

namespace lamplock::boards {
namespace mrbeam_pins {
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
    PinUse{Role::estop, 27, input, false, "E-STOP"},
    PinUse{Role::door, 21, input, false, "DOOR"},
    PinUse{Role::q_switch, 22, output, true, "Q-SWITCH"},
    PinUse{Role::tick_line, 25, output, false, "TICK"},
    PinUse{Role::lamp_sync, 26, input, false, "LAMP SYNC"},
    PinUse{Role::probe, 19, input, false, "PROBE"},
};
inline constexpr std::array maps{MapRow{"mrbeam", pins}};
}  // namespace mrbeam_pins

inline constexpr BoardRow mrbeam{.name = "mrbeam",
                                 .image = "lamplock-mrbeam",
                                 .first_map = PinMap{5},
                                 .maps = mrbeam_pins::maps,
                                 .reserved = mask_of(23, 24, 29),
                                 .pulled_up = mask_of(8),
                                 .uses_e5_pin = true};
static_assert(is_sound(mrbeam));

}  // namespace lamplock::boards
