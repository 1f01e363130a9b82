// The second link of a Raspberry Pi Pico, a UART: settings of both ends of the cable.
#pragma once

#include <cstdint>

namespace lamplock::boards {

/// 8N1; exact at 125 MHz.
inline constexpr std::uint32_t uart_baud = 1'000'000;

}  // namespace lamplock::boards
