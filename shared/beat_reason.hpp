// The use of a beat: every lamp period of a job is counted under exactly one of these.
//
// The shot scheduler counts them, STATUS carries the counts, the report prints them by name.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace lamplock {

/// Why a beat had its shot, or had none. The values are part of the wire format: never renumber.
enum class BeatReason : std::uint8_t {
  fired = 0,              ///< a shot at its point
  no_point_due = 1,       ///< no shot here: a pass, a dwell, or no plan
  moving = 2,             ///< the next point cannot be reached on this beat
  outside_tolerance = 3,  ///< at the edge the machine was too far from the point
  no_edge = 4,            ///< the lamp did not flash
  returning = 5,          ///< the machine returns to a point that was missed
  not_locked = 6,         ///< the beat clock does not follow the lamp
  hold = 7,
  door = 8,
  alarm = 9,
  starved = 10,     ///< no points from the host
  warm_up = 11,     ///< the lamp's first flashes
  protection = 12,  ///< highest shot rate, or the machine waits for shutter or attenuator
  dry = 13,         ///< the job moves without firing
};

/// Places reserved for reasons in STATUS.
inline constexpr std::size_t max_beat_reasons = 16;
inline constexpr std::size_t beat_reason_count = static_cast<std::size_t>(BeatReason::dry) + 1;
static_assert(beat_reason_count <= max_beat_reasons);

/// Names for reports, by value.
inline constexpr std::array<std::string_view, beat_reason_count> beat_reason_names{
    "fired", "no_point_due", "moving", "outside_tolerance", "no_edge", "returning",  "not_locked",
    "hold",  "door",         "alarm",  "starved",           "warm_up", "protection", "dry"};

constexpr std::string_view name(BeatReason reason) {
  return beat_reason_names[static_cast<std::size_t>(reason)];
}

/// Beats counted by reason, indexed by BeatReason.
using BeatsByReason = std::array<std::uint32_t, max_beat_reasons>;

}  // namespace lamplock
