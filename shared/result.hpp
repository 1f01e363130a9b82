// Result codes of the firmware. A function that can fail returns one; nothing throws.
#pragma once

#include <cstdint>

namespace lamplock {

/// The reason of a refusal. The values are part of the wire format: never renumber.
enum class Result : std::uint8_t {
  ok = 0,
  bad_frame = 1,           ///< malformed payload (length, unknown record or frame type)
  no_space = 3,            ///< the point buffer cannot take the whole frame
  no_job = 4,              ///< data or command outside a job
  busy = 5,                ///< not possible in this state (job running, not idle)
  locked = 6,              ///< alarm: unlock or home first
  bad_value = 7,           ///< a number outside its range
  out_of_bounds = 8,       ///< target outside the work space
  bad_version = 9,         ///< other protocol version
  settings_mismatch = 10,  ///< job was made for other settings
  unreachable = 11,        ///< limits make it impossible to reach the target
  unsupported = 12,        ///< known but not available on this board or in this version
  door_open = 13,          ///< safety door or e-stop is active
  held = 14,               ///< a hold (`!`, 0x84) at rest has not been ended by `~`
};

}  // namespace lamplock
