// PicoBOB by Expatria Technologies (docs/boards/picobob.md): a Pico in place of the parallel port
// of a Mach3 breakout board. Pins: grblHAL, RP2040, boards/picobob_map.h.
//
// The five inputs come through inverters with Schmitt triggers, which always drive their pads. The
// outputs of GPIO 14 and 16 end in open collectors. There is no enable of the drives, and no input
// is left for a door.
#pragma once

#include "shared/boards/board_row.hpp"

namespace lamplock::boards {
namespace picobob_pins {
using enum Direction;

inline constexpr std::array pins{
    PinUse{Role::step_x, 17, output, false, "X STEP"},
    PinUse{Role::dir_x, 9, output, false, "X DIR"},
    PinUse{Role::step_y, 18, output, false, "Y STEP"},
    PinUse{Role::dir_y, 10, output, false, "Y DIR"},
    PinUse{Role::step_z, 19, output, false, "Z STEP"},
    PinUse{Role::dir_z, 11, output, false, "Z DIR"},
    PinUse{Role::lamp_sync, 5, input, false, "LAMP SYNC", true},
    PinUse{Role::q_switch, 21, output, true, "Q-SWITCH"},
    PinUse{Role::lamp_trigger, 12, output, true, "LAMP TRIGGER"},
    PinUse{Role::laser_gate, 13, output, true, "LASER GATE"},
    PinUse{Role::shot_enable, 14, output, true, "SHOT ENABLE"},
    PinUse{Role::laser_pwm, 16, output, true, "LASER PWM"},
    PinUse{Role::estop, 3, input, false, "E-STOP", true},
    PinUse{Role::probe, 4, input, false, "PROBE", true},
    PinUse{Role::limit_x, 2, input, false, "X LIMIT", true},
    PinUse{Role::limit_y, 1, input, false, "Y LIMIT", true},
    PinUse{Role::tick_line, 25, output, false, "TICK"},
};
inline constexpr std::array maps{MapRow{"picobob", pins}};
}  // namespace picobob_pins

inline constexpr BoardRow picobob{.name = "picobob",
                                  .image = "lamplock-picobob",
                                  .first_map = PinMap{3},
                                  .maps = picobob_pins::maps,
                                  .reserved = mask_of(23, 24, 29),
                                  .driven = mask_of(1, 2, 3, 4, 5)};
static_assert(is_sound(picobob));

}  // namespace lamplock::boards
