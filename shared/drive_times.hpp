// Times that drives need, for the machine that drives them and for drives that are simulated.
#pragma once

#include <cstdint>

namespace lamplock {

/// A released drive holds, and accepts steps, this long after its enable: some stepper drives need
/// 200 ms and lose steps before (grbl-Mega-5X issue 364: a DM556T), others 5 us (g2 issue 290: an
/// AM882). grbl does not wait (grbl issue 522: a DM542T loses steps).
inline constexpr std::uint32_t drive_wake_ms = 200;

}  // namespace lamplock
