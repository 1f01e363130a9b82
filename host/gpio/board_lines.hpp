// Resets a board by lines of the computer at its pins RUN and BOOTSEL.
//
// In:  the lines, and the table of those wired to the board. Out: a board that restarts, with its
//      firmware or in its boot loader. The caller must make sure that no job runs. Outputs of a
//      board in reset are not driven, which means laser off (docs/wiring.md). Both pins are always
//      released, also after errors; signals are deferred until then.
// Who: `lamplock lines reset`, `lamplock lines loader`, `lamplock flash --lines`.
#pragma once

#include <chrono>
#include <functional>

#include "host/gpio/line_table.hpp"
#include "host/gpio/lines.hpp"

namespace lamplock::gpio {

/// Waits.
using Sleep = std::function<void(std::chrono::milliseconds)>;

/// Duration of the low pulse on RUN: a supervisor ignores spikes.
inline constexpr std::chrono::milliseconds reset_pulse{20};
/// BOOTSEL is held for this time after the pulse. The boot ROM reads it early (RP2040 datasheet,
/// 2.8.1), but the supervisor that docs/wiring.md requires keeps RUN low for up to 0.3 s more.
inline constexpr std::chrono::milliseconds boot_select_hold{500};

/// Pulses RUN. Throws Error: bad_input (the table has no line for it), no_device (the line cannot
/// be requested, or was lost).
void reset_board(Lines& lines, const LineTable& table, const Sleep& sleep);

/// Throws Error(bad_input) if one of the pins has no line.
void expect_loader_lines(const LineTable& table);

/// Pulses RUN while BOOTSEL is low: the board starts its boot loader. Throws as reset_board().
void enter_loader(Lines& lines, const LineTable& table, const Sleep& sleep);

/// Sleep in real time.
void real_sleep(std::chrono::milliseconds time);

}  // namespace lamplock::gpio
