// The lattice of the beat clock: lengths of ticks, corrected towards the lamp.
#include "firmware/lamp/beat_clock.hpp"

#include "firmware/lamp/clock_arithmetic.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::lamp {
namespace {

using settings::LampMode;

/// Maximum stretch of a tick while nothing moves: a quarter.
constexpr int rest_slew_bits = 2;
/// The lattice has settled when it is within this and half a jitter of the lamp.
constexpr std::int64_t settled_q16 = std::int64_t{clocks_per_us} << 16;

/// Longest run of ticks: for a lamp that is 10 % slow ($905), stretched by a quarter at rest, its
/// clocks still fit 16 bits.
constexpr std::uint32_t max_run_ticks = clocks_per_tick * 256 * 11 / 8 < 65'536 ? 256 : 128;
static_assert(clocks_per_tick * max_run_ticks * 11 / 8 < 65'536);

/// Clocks of a run of ticks, Q16. Two products of 32 bits.
inline std::uint32_t run_q16(std::int64_t tick_q32, std::uint32_t ticks) {
  const auto tick_q16 = static_cast<std::uint32_t>(tick_q32 >> 16);
  const std::uint32_t rest = static_cast<std::uint32_t>(tick_q32) & 0xffff;
  return tick_q16 * ticks + (rest * ticks >> 16);
}
constexpr std::uint32_t nominal_tick_q16 = nominal_tick_q32 >> 16;

}  // namespace

void BeatClock::set_min_tick(std::uint64_t from_tick, std::uint32_t tick_q16) {
  min_ticks_.set(tick_, from_tick, std::int64_t{tick_q16} * (nominal_tick_q32 >> 16));
}

std::uint32_t BeatClock::ticks_in(std::uint32_t clocks) const {
  const auto tick_q16 = static_cast<std::uint32_t>(tick_q32_ >> 16);
  return static_cast<std::uint32_t>(((std::uint64_t{clocks} << 16) + tick_q16 / 2) / tick_q16);
}

void BeatClock::set_tick_length(std::uint64_t from_tick, std::uint32_t tick_q16) {
  if (mode_ != LampMode::master) return;
  const std::int64_t spread = max_tick_q16_ - full_tick_q16;
  const std::int64_t length = clamped(tick_q16, full_tick_q16 - spread, full_tick_q16 + spread);
  length_.set(tick_, from_tick, length * (nominal_tick_q32 >> 16));
}

std::int64_t BeatClock::lattice_error_q16() const { return difference(aim_q16_, clock_q16_); }

bool BeatClock::settled() const {
  if (mode_ != LampMode::slave) return true;
  return locked_ && abs64(lattice_error_q16()) < settled_q16 + jitter_q16_ / 2;
}

/// Length of a run of ticks, one of 2^fold in a row, corrected towards the lamp.
std::uint32_t BeatClock::steered(std::uint32_t length, std::uint32_t ticks, int fold) {
  const bool moving = tick_ < motion_end_tick_;
  if (mode_ == LampMode::slave && locked_) {
    std::int64_t all = lattice_error_q16();
    // A lattice that cannot follow would eventually be a beat off the lamp.
    if (tick_in_beat_ == 0 &&
        (beat_ > predicted_beat_ + missed_to_loss || (on_lamp_ && abs64(all) > period_q16_ >> 2)))
      lose();
    if (abs64(all) < settled_q16) on_lamp_ = true;
    if (fold != 0) all >>= fold;
    constexpr std::int32_t largest = 0x7fffffff;
    const std::int32_t error = all == static_cast<std::int32_t>(all)
                                   ? static_cast<std::int32_t>(all)
                               : all < 0 ? -largest
                                         : largest;
    const auto most = static_cast<std::int32_t>(
        moving ? static_cast<std::uint32_t>(wide_product(length, slew_q32_) >> 32)
               : length >> rest_slew_bits);
    length += static_cast<std::uint32_t>(error < -most ? -most : error > most ? most : error);
    // At most a quarter off nominal, however far the lamp is: boards rely on that.
    const std::uint32_t low = nominal_tick_q16 / 4 * 3 * ticks;
    const std::uint32_t high = nominal_tick_q16 / 4 * 5 * ticks;
    if (length < low) length = low;
    if (length > high) length = high;
  }
  if (!moving) return length;
  // The lattice lags rather than motion exceeding its limits.
  const std::uint32_t least = run_q16(min_ticks_.most(tick_, tick_ + ticks + lead_ticks_), ticks);
  return length < least ? least : length;
}

TickSpan BeatClock::next_span(std::uint32_t max_ticks) {
  const std::uint32_t left = beat_ticks_ - tick_in_beat_;
  std::uint32_t run = max_ticks < left ? max_ticks : left;
  // Longer than boards request: all runs equal.
  int fold = 0;
  for (; run > max_run_ticks; run >>= 1) ++fold;
  TickSpan span;
  span.first_tick = tick_;
  span.ticks = run << fold;
  if (tick_in_beat_ == 0) beat_starts_[start_place(beat_)] = clock_q16_;
  const std::int64_t tick_q32 = mode_ == LampMode::master ? length_.at(tick_) : tick_q32_;
  const std::uint32_t free_run = run_q16(tick_q32, run);
  ClockQ16 free_length = free_run, length = steered(free_run, run, fold);
  if (fold != 0) free_length <<= fold, length <<= fold;
  span.first_clock = clock_;
  span.clocks = static_cast<std::uint32_t>((length + (clock_q16_ & 0xffff)) >> 16);
  clock_ += span.clocks;
  clock_q16_ += length;
  tick_ += span.ticks;
  tick_in_beat_ += span.ticks;
  aim_q16_ += free_length;
  if (tick_in_beat_ == beat_ticks_) {
    tick_in_beat_ = 0;
    ++beat_;
    if (mode_ == LampMode::master && locked_ && ++silent_beats_ > missed_to_loss) lose();
    beat_aim_q16_ += static_cast<ClockQ16>(period_q16_);
    aim_q16_ = beat_aim_q16_;
  }
  return span;
}

EdgeInfo BeatClock::nearest_beat(ClockQ16 clock_q16) {
  // A trigger of ours: the edge belongs to the beat of the lattice tick that follows it.
  const std::int64_t beat_q16 = std::int64_t{beat_ticks_} * (nominal_tick_q32 >> 16);
  const std::uint32_t left = beat_ticks_ - tick_in_beat_;
  const ClockQ16 shot_q16 = clock_q16 + static_cast<ClockQ16>(delay_q16_);
  // The next beat without a time, if the present one keeps its length, and from there backwards.
  const std::int64_t rest_q16 = (length_.at(tick_) * left) >> 16;
  std::uint64_t beat = beat_ + 1;
  std::int64_t off_q16 = difference(shot_q16, clock_q16_ + static_cast<ClockQ16>(rest_q16));
  for (std::uint32_t back = 0;
       off_q16 < -beat_q16 / 2 && back < beat_starts_.size() && beat != origin_beat_; ++back) {
    --beat;
    const ClockQ16 start_q16 =
        tick_in_beat_ == 0 && beat == beat_ ? clock_q16_ : beat_starts_[start_place(beat)];
    off_q16 = difference(shot_q16, start_q16);
  }
  EdgeInfo info{true, beat, 0};
  if (abs64(off_q16) > beat_q16 / 4) {
    ++spurious_;
    return {};
  }
  if (good_edges_ != 0 && beat > predicted_beat_)
    info.missed = static_cast<std::uint32_t>(beat - predicted_beat_);
  if (good_edges_ != 0 && beat < predicted_beat_) {
    ++spurious_;
    return {};
  }
  good_edges_ = 1;
  predicted_beat_ = beat + 1;
  return info;
}

}  // namespace lamplock::lamp
