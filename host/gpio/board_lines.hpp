// RUN and BOOTSEL of a board, pulled by lines of the computer: reset without pulling the plug.
//
// In:  the lines, which of them are wired to the board. Out: a board that starts anew, with its
//      firmware or in its boot loader. Nothing is asked before: whoever calls has seen that no job
//      runs. Outputs of a board in reset are not driven, which is laser off (docs/wiring.md).
//      Both pins are let go whatever happens: errors, and signals, which wait until then.
// Who: `lamplock lines reset`, `lamplock lines loader`, `lamplock flash --lines`.
#pragma once

#include <chrono>
#include <functional>

#include "host/gpio/line_table.hpp"
#include "host/gpio/lines.hpp"

namespace lamplock::gpio {

/// Lets time pass.
using Sleep = std::function<void(std::chrono::milliseconds)>;

/// RUN is pulled low for so long: a supervisor on it wants to see more than a spike.
inline constexpr std::chrono::milliseconds reset_pulse{20};
/// BOOTSEL is held so long behind it. The boot ROM looks at it early (RP2040 datasheet, 2.8.1), but
/// the supervisor that docs/wiring.md asks for keeps RUN low for up to 0.3 s more.
inline constexpr std::chrono::milliseconds boot_select_hold{500};

/// Pulses RUN. Throws Error: bad_input (no line named for it), no_device (it cannot be had, or is
/// gone).
void reset_board(Lines& lines, const LineTable& table, const Sleep& sleep);

/// Throws Error(bad_input) if one of the pins has no line.
void expect_loader_lines(const LineTable& table);

/// Pulses RUN while BOOTSEL is low: the board comes back in its boot loader. Throws as
/// reset_board().
void enter_loader(Lines& lines, const LineTable& table, const Sleep& sleep);

/// Sleep in real time.
void real_sleep(std::chrono::milliseconds time);

}  // namespace lamplock::gpio
