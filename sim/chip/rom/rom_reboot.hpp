// How the boot ROM resets its own chip: by the watchdog, with or without a boot vector (RP2040
// datasheet, 2.8.1.1).
//
// In:  where to continue. Out: stores to the watchdog, PSM and CLOCKS.
// Who: reset_to_usb_boot, PICOBOOT REBOOT; the ROM's start reads the vector.
#pragma once

#include <cstdint>

#include "sim/chip/rom/picoboot.hpp"

namespace lamplock::sim::chip::rom {

/// Four words of the watchdog's scratch registers: magic, check of the entry, stack, entry.
inline constexpr std::uint32_t boot_vector = 0x4005'801c;
inline constexpr std::uint32_t boot_magic = 0xb007'c0d3;

/// Starts the watchdog. `entry` 0: the ordinary start. The real ROM loads 1000 counts a millisecond
/// in all its versions (published source), of which erratum RP2040-E1 takes two a microsecond: the
/// reset comes after half the time requested.
void reboot(LoaderBus& bus, std::uint32_t entry, std::uint32_t stack, std::uint32_t milliseconds);

}  // namespace lamplock::sim::chip::rom
