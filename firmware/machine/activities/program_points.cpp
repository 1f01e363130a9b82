#include "firmware/machine/activities/program_points.hpp"

#include <limits>

#include "firmware/machine/runners/program_motion.hpp"
#include "shared/beat.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;

/// Lengths in hundredths of a micrometre: squares of the longest way fit 64 bits.
constexpr std::int64_t parts_per_mm = 100'000, parts_per_um = parts_per_mm / 1000;
constexpr std::int64_t us_per_min = 60'000'000;
constexpr std::int64_t ticks_per_us = ticks_per_second / 1'000'000;
/// Rounding to steps must not cost a beat: a speed above the feed rate by at most this fraction is
/// accepted.
constexpr std::int64_t tolerated_part = 64;

/// Distance that an axis moves.
std::int64_t way_of(const MoveEnds& ends, const settings::Values& values, int a) {
  const std::int64_t steps = std::int64_t{ends.to[index(a)]} - ends.from[index(a)];
  return abs64(steps) * (parts_per_mm * 1000) / values.milli(Id::steps_per_mm_x, a);
}

std::int64_t time_at_feed_us(const program::Action& move, const MoveEnds& ends,
                             const settings::Values& values) {
  if (move.timed) return move.time_us;
  std::uint64_t squares = 0;
  for (int a = 0; a < values.whole(Id::axes); ++a) {
    const auto way = static_cast<std::uint64_t>(way_of(ends, values, a));
    squares += way * way;
  }
  const std::int64_t feed = move.feed_um_min == 0 ? 1 : std::int64_t{move.feed_um_min};
  return std::int64_t{isqrt(squares)} * (us_per_min / parts_per_um) / feed;
}

/// Time with each axis at its maximum speed.
std::int64_t time_of_rapid_us(const MoveEnds& ends, const settings::Values& values) {
  std::int64_t longest = 0;
  for (int a = 0; a < values.whole(Id::axes); ++a) {
    const std::int64_t um_min = values.milli(Id::max_rate_x, a);
    const std::int64_t time = way_of(ends, values, a) * (us_per_min / parts_per_um) / um_min;
    if (time > longest) longest = time;
  }
  return longest;
}

/// Whole beats; 0 if one is enough.
std::uint16_t beats_of(std::int64_t time_us, const settings::Values& values) {
  const std::int64_t beat = beat_ticks(values);
  const std::int64_t ticks = time_us * ticks_per_us;
  const std::int64_t beats = (ticks - beat / tolerated_part + beat - 1) / beat;
  constexpr std::int64_t most = std::numeric_limits<std::uint16_t>::max();
  return static_cast<std::uint16_t>(beats <= 1 ? 0 : beats < most ? beats : most);
}

}  // namespace

wire::Target point_target(const program::Action& move, const MoveEnds& ends, std::uint8_t channel,
                          const settings::Values& values) {
  wire::Target target;
  target.steps = ends.to;
  target.stop = move.exact_stop;
  target.rapid = move.rapid;
  target.channel = channel;
  target.shots = !move.rapid && move.programmed_end ? 1 : 0;
  if (target.shots != 0 && values.whole(Id::laser_mode) != 0) {
    target.energy = move.spindle == program::Spindle::off ? 0 : power_of(move.speed_milli, values);
    if (target.energy == 0) target.shots = 0;
  }
  target.beats = beats_of(
      move.rapid ? time_of_rapid_us(ends, values) : time_at_feed_us(move, ends, values), values);
  return target;
}

}  // namespace lamplock::machine
