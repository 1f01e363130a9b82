// The effort of the search, from the time that is available per point.
//
// In:  about how long the machine takes per point.
// Out: limits of the search.
// Who: the planner (planner.hpp), once per window.
//
// Planning must be faster than the machine. On a separate core (125 MHz) and with three axes the
// quick search takes 0.6 to 0.7 ms a point, the thorough one 1.1 ms and 0.5 ms more for each label
// beyond the first. The effort depends only on points and settings, so the plan does too.
#pragma once

#include <cstdint>

#include "shared/units.hpp"

namespace lamplock::motion {

/// Maximum labels kept per point.
inline constexpr std::uint32_t max_labels = 8;

/// Limits of the search.
struct Effort {
  std::uint32_t labels = 1;          ///< kept per point (beam_search.hpp), 1..max_labels
  std::int32_t candidate_share = 4;  ///< candidates of k beats are 1 + k/share apart
  bool pairs = false;                ///< moves between two ways (beat_reduction.hpp)
};

/// `ticks` per point. A candidate share of 16 is within 0.2 % of the exact optimum where a way
/// takes tens of beats, 4 within 1 %.
constexpr Effort effort_for(std::uint64_t ticks) {
  constexpr std::uint32_t thorough_ticks = 1600 * (ticks_per_second / 1'000'000);
  constexpr std::uint32_t label_ticks = thorough_ticks / 2;
  if (ticks < thorough_ticks) return {};
  const std::uint64_t labels = 1 + (ticks - thorough_ticks) / label_ticks;
  return {labels < max_labels ? static_cast<std::uint32_t>(labels) : max_labels, 16, true};
}

}  // namespace lamplock::motion
