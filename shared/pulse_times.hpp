// The times of step pulses on the lattice of ticks: one definition for planner, boards and host.
//
// In:  the settings $0 (step_pulse) and $1077 (step_low).
// Out: how many ticks a pulse is high, how many ticks are between two steps at least, and the
//      highest rate that an axis can have with them. In quadrature, where every edge is a step, the
//      time between two edges.
//
// A pulse begins with a tick. A short one ends inside this tick, with the tick line of the board;
// a longer one ends with a later tick. Steps of an axis that moves v steps a tick are at least
// floor(1/v) ticks apart, so v <= 1/N keeps N ticks between any two.
//
//   tick         0     1     2     3     4     5     6
//   short        #_____                                    N = 1
//   2.5 us       ##################__________________#     high 3 ticks, low 3 ticks, N = 6
#pragma once

#include <algorithm>
#include <cstdint>

#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock {

/// High time of the shortest pulse: pulses up to this one end inside their tick.
inline constexpr std::uint32_t short_pulse_ns = 500;
/// No tick is shorter than this while the machine moves: the period of the lamp may be 10 % off
/// nominal ($905, $910), a tick 5 % off that ($906), a beat has 125 ticks or more, rounded, and a
/// tick ends up to a clock early.
inline constexpr std::uint32_t min_moving_tick_ns = 840;
static_assert(min_moving_tick_ns <
              (1.0 - settings::range(settings::Id::lock_range).max_milli / 1e5) *
                      (1.0 - settings::range(settings::Id::slew_limit).max_milli / 1e5) *
                      (1.0 - settings::range(settings::Id::lamp_frequency).max_milli / 2e9) *
                      tick_ns -
                  8);
static_assert(min_moving_tick_ns >= min_tick_ns);
/// After a short pulse the rest of its tick is low: two clocks less at a pad of the slowest board.
inline constexpr std::uint32_t short_low_ns = min_moving_tick_ns - short_pulse_ns - 16;

/// Pulses in ticks.
struct PulseTimes {
  std::uint8_t high_ticks = 0;    ///< 0: short
  std::uint8_t period_ticks = 1;  ///< from step to step at least

  friend constexpr bool operator==(const PulseTimes&, const PulseTimes&) = default;
};

/// Whole ticks that last at least this long while the machine moves.
constexpr std::uint32_t moving_ticks(std::uint32_t ns) {
  return (ns + min_moving_tick_ns - 1) / min_moving_tick_ns;
}

/// Pulses as set.
constexpr PulseTimes pulse_times(const settings::Values& values) {
  const auto high_ns = static_cast<std::uint32_t>(values.milli(settings::Id::step_pulse));
  const auto low_ns = static_cast<std::uint32_t>(values.milli(settings::Id::step_low));
  if (high_ns > short_pulse_ns) {
    const std::uint32_t high = moving_ticks(high_ns);
    return {static_cast<std::uint8_t>(high),
            static_cast<std::uint8_t>(high + moving_ticks(low_ns))};
  }
  const std::uint32_t more = low_ns <= short_low_ns ? 0 : moving_ticks(low_ns - short_low_ns);
  return {0, static_cast<std::uint8_t>(1 + more)};
}

/// Share of a step that an axis moves at most in `period_ticks`, in hundredths: the rest is for
/// rounding.
inline constexpr std::uint32_t max_step_percent = 98;
/// The same for the sum of two axes that share motors. A tick that follows the lamp ($905, $910,
/// $906) is up to a sixth too long.
inline constexpr std::uint32_t max_shared_step_percent = 80;

/// Highest max_rate of an axis that leaves time for its pulses, in thousandths of mm/min.
constexpr std::int64_t max_rate_milli(const settings::Values& values, int axis,
                                      std::uint32_t percent = max_step_percent) {
  // Steps per minute times 10^6.
  constexpr std::int64_t one_percent = std::int64_t{ticks_per_second} * 60 / 100 * 1'000'000;
  return one_percent * percent / pulse_times(values).period_ticks /
         values.milli(settings::Id::steps_per_mm_x, axis);
}

namespace settings {

/// An axis whose max_rate leaves no time for its pulses.
struct RateExcess {
  int axis = -1;               ///< none
  bool is_shared = false;      ///< the sum of X and Y of a CoreXY, whose motors they share
  std::int64_t max_milli = 0;  ///< highest max_rate, or highest sum, in thousandths of mm/min
};

/// The first one.
[[gnu::cold]] constexpr RateExcess rate_excess(const Values& values) {
  const auto rate = [&values](int axis) {
    return std::int64_t{values.milli(Id::max_rate_x, axis)};
  };
  for (int axis = 0; axis < values.whole(Id::axes); ++axis)
    if (const std::int64_t most = max_rate_milli(values, axis); rate(axis) > most)
      return {axis, false, most};
  const std::int64_t together = max_rate_milli(values, 1, max_shared_step_percent);
  if (values.milli(Id::kinematics) != 0 && rate(0) + rate(1) > together) return {1, true, together};
  return {};
}

}  // namespace settings
}  // namespace lamplock
