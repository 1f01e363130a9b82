#include "firmware/motion/path/pulse_line.hpp"

#include "firmware/motion/path/real.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::motion {
namespace {

/// Ramps are found to 1/256 of their phase and have whole ticks; this share is larger. A pulse that
/// does not reach its peak loses at most as much.
constexpr int ramp_room_bits = 7;
constexpr int short_room_bits = ramp_room_bits - 1;

std::int64_t min_of(std::int64_t a, std::int64_t b) { return a < b ? a : b; }
std::int64_t max_of(std::int64_t a, std::int64_t b) { return a > b ? a : b; }

/// a / b in Q32, rounded down except for the last bits, a >= 0 and b > 0: in two steps of 32 bits.
std::int64_t ratio_q32(std::int64_t a, std::int64_t b) {
  const Real divisor = Real::of_q32(b);
  const std::int64_t most = (Real::of_q32(a) / divisor).fixed(32);
  return most + (Real::of_q32(a - mul_q32(most, b)) / divisor).fixed(32);
}

/// Change of speed that a pulse can make.
std::int64_t pulse_change_q32(const PulseLine& line, std::int64_t length_q32) {
  const std::int64_t rise = line.rise_q32 + (length_q32 >> ramp_room_bits);
  if (length_q32 >= 2 * rise) return length_q32 - rise;
  // Too short to reach its peak; if much too short, it needs no ramp.
  return mul_q32(length_q32, max_of(mul_q32(length_q32, line.per_rise_q32), line.flat_q32));
}

/// A line divided for some beats.
struct Division {
  std::int64_t lead_half_q32;
  std::int64_t tail_half_q32;
  std::int64_t mean_q32;    ///< M
  std::int64_t first_q32;   ///< D(l)
  std::int64_t second_q32;  ///< D(m)

  Division(const PulseLine& line, std::int32_t beats, int split) {
    const PulseLengths pulses = pulse_lengths(line, beats, split);
    lead_half_q32 = pulses.lead_q32 / 2;
    tail_half_q32 = pulses.tail_q32 / 2;
    mean_q32 = (std::int64_t{beats} << 32) - lead_half_q32 - tail_half_q32;
    first_q32 = pulse_change_q32(line, pulses.lead_q32);
    second_q32 =
        pulses.tail_q32 == pulses.lead_q32 ? first_q32 : pulse_change_q32(line, pulses.tail_q32);
  }

  std::int64_t way_q32(std::int64_t v0, std::int64_t vc, std::int64_t v1) const {
    return mul_q32(lead_half_q32, v0) + mul_q32(mean_q32, vc) + mul_q32(tail_half_q32, v1);
  }
  /// The longest distance from at most v0 to at most v1, and the shortest one from at least v0: all
  /// distances between them are possible.
  std::int64_t max_q32(std::int64_t v0, std::int64_t limit, std::int64_t v1) const {
    const std::int64_t vc = min_of(limit, min_of(v0 + first_q32, v1 + second_q32));
    return way_q32(min_of(v0, vc + first_q32), vc, min_of(v1, vc + second_q32));
  }
  std::int64_t min_q32(std::int64_t v0) const {
    const std::int64_t vc = max_of(v0 - first_q32, 0);
    return way_q32(v0, vc, max_of(vc - second_q32, 0));
  }

  /// Highest speed at the end of a distance, from at least v0; negative if the distance is too
  /// short. The shortest distance to a speed v1 has the lowest possible v0 and vc: both are
  /// constant while v1 rises, then vc follows, then v0 as well.
  std::int64_t max_end_q32(std::int64_t way, std::int64_t v0) const {
    const std::int64_t vc = max_of(v0 - first_q32, 0);
    const std::int64_t beyond = way - way_q32(v0, vc, 0);
    if (beyond < 0) return -1;
    const std::int64_t follows = vc + second_q32, all_follow = v0 + first_q32 + second_q32;
    const std::int64_t first_part = mul_q32(tail_half_q32, follows);
    if (beyond <= first_part) return ratio_q32(beyond, tail_half_q32);
    const std::int64_t slope = tail_half_q32 + mean_q32;
    const std::int64_t second_part = mul_q32(slope, all_follow - follows);
    if (beyond - first_part <= second_part) return follows + ratio_q32(beyond - first_part, slope);
    return all_follow + ratio_q32(beyond - first_part - second_part, slope + lead_half_q32);
  }
};

/// True if the line is not too long for some division of the time; the number of beats it needs
/// grows with its length.
bool goes_far_enough(const PulseLine& line, const SpeedInterval& from, std::int32_t beats,
                     std::int64_t end) {
  for (int split = 0; split < pulse_splits; ++split)
    if (Division(line, beats, split).max_q32(from.hi_q32, line.speed_q32, end) >
        line.displacement_q32)
      return true;
  return false;
}

bool reaches(const PulseLine& line, const SpeedInterval& from, std::int32_t beats,
             std::int64_t end) {
  for (int split = 0; split < pulse_splits; ++split) {
    const Division d(line, beats, split);
    if (d.max_q32(from.hi_q32, line.speed_q32, end) > line.displacement_q32 &&
        d.min_q32(from.lo_q32) < line.displacement_q32)
      return true;
  }
  return false;
}

/// Fewest beats for which the line is not too long, searched from `hint` on; `most` + 1 if there
/// are none.
std::int32_t far_enough(const PulseLine& line, const SpeedInterval& from, std::int64_t end,
                        std::int32_t least, std::int32_t most, std::int32_t hint) {
  const auto enough = [&](std::int32_t k) { return goes_far_enough(line, from, k, end); };
  std::int32_t low = least - 1, high = hint < least ? least : hint > most ? most : hint;
  if (enough(high)) {
    for (std::int32_t step = 1; high - step > low; step *= 2) {
      if (!enough(high - step)) {
        low = high - step;
        break;
      }
      high -= step;
    }
  } else {
    low = high;
    for (std::int32_t step = 1;; step *= 2) {
      high = low + step;
      if (high > most) {
        high = most + 1;
        break;
      }
      if (enough(high)) break;
      low = high;
    }
  }
  while (high - low > 1) {
    const std::int32_t middle = low + (high - low) / 2;
    (enough(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace

PulseLine make_pulse_line(std::int64_t displacement_q32, std::int64_t speed_q32,
                          std::int64_t rise_q32, std::int64_t flat_q32) {
  PulseLine line{displacement_q32, speed_q32, rise_q32, flat_q32};
  const std::int64_t quarter = ratio_q32(one_q32, 4 * rise_q32);
  line.per_rise_q32 = quarter - (quarter >> short_room_bits);
  const bool long_ramps = speed_q32 > rise_q32;
  const std::int64_t time =
      long_ramps ? speed_q32 + rise_q32 : 2 * sqrt_down_q32(mul_q32(speed_q32, rise_q32));
  line.max_q32 = time + (time >> short_room_bits);
  return line;
}

PulseLengths pulse_lengths(const PulseLine& line, std::int32_t beats, int split) {
  const std::int64_t eighth = std::int64_t{beats} << 29;
  const std::int64_t lead = split == 0 ? 4 * eighth : split == 1 ? 6 * eighth : 2 * eighth;
  return {min_of(lead, line.max_q32), min_of(8 * eighth - lead, line.max_q32)};
}

bool pulse_reach(const PulseLine& line, const SpeedInterval& from, std::int32_t beats, int split,
                 std::int64_t end, SpeedInterval& to) {
  const Division d(line, beats, split);
  const std::int64_t v = line.speed_q32;
  // The bounds of the slowest start, and, in the frame of the highest speed, of the quickest.
  to.hi_q32 = d.max_end_q32(line.displacement_q32, from.lo_q32);
  const std::int64_t mirrored = times_short(v, static_cast<std::uint32_t>(beats));
  const std::int64_t below = d.max_end_q32(mirrored - line.displacement_q32, v - from.hi_q32);
  if (to.hi_q32 < 0 || below < 0) return false;
  const std::int64_t changes = d.first_q32 + d.second_q32;
  to.lo_q32 = max_of(max_of(v - below, from.lo_q32 - changes), 0);
  to.hi_q32 = min_of(min_of(to.hi_q32, from.hi_q32 + changes), min_of(end, v));
  return to.lo_q32 <= to.hi_q32;
}

std::int32_t fewest_pulse_beats(const PulseLine& line, const SpeedInterval& from, std::int64_t end,
                                std::int32_t least, std::int32_t most, std::int32_t hint) {
  std::int32_t beats = far_enough(line, from, end, least, most, hint);
  if (beats > most) return 0;
  if (reaches(line, from, beats, end)) return beats;
  // Times longer than from rest to rest are never needed.
  const std::int32_t rest = far_enough(line, {0, 0}, 0, least, most, beats);
  while (++beats <= rest && beats <= most)
    if (reaches(line, from, beats, end)) return beats;
  return 0;
}

}  // namespace lamplock::motion
