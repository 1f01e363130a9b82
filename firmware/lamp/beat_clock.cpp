#include "firmware/lamp/beat_clock.hpp"

#include "shared/beat.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::lamp {
namespace {

using settings::Id;
using settings::LampMode;

constexpr std::int64_t nominal_tick_q32 = std::int64_t{clocks_per_tick} << 32;
/// How far a tick may be stretched while nothing moves: a quarter.
constexpr std::int64_t rest_slew_q32 = one_q32 / 4;
/// Edges in a row that fit no beat, or beats without an edge, until the lock counts as lost.
constexpr std::uint32_t strays_to_loss = 6;
constexpr std::uint32_t missed_to_loss = 32;
/// The lattice has settled when it is within this of the lamp.
constexpr std::int64_t settled_q16 = std::int64_t{4 * clocks_per_us} << 16;

/// Signed difference of two times that may have wrapped.
std::int64_t difference(std::uint64_t later_q16, std::uint64_t earlier_q16) {
  return static_cast<std::int64_t>(later_q16 - earlier_q16);
}

std::int64_t clamped(std::int64_t x, std::int64_t low, std::int64_t high) {
  return x < low ? low : x > high ? high : x;
}

/// A setting in us (kept in thousandths) to clocks, Q16.
std::int64_t us_to_clocks_q16(std::int32_t milli_us) {
  return mul_div(std::int64_t{milli_us} << 16, clocks_per_us, 1000);
}

}  // namespace

void BeatClock::configure(const settings::Values& values) {
  mode_ = static_cast<LampMode>(values.whole(Id::lamp_mode));
  beat_ticks_ = lamplock::beat_ticks(values);
  // The frequency is in mHz: clocks per beat = clock_hz * 1000 / mHz.
  nominal_q16_ = mul_div(std::int64_t{clock_hz} << 16, 1000,
                         static_cast<std::uint32_t>(values.milli(Id::lamp_frequency)));
  range_q16_ = mul_div(nominal_q16_, values.milli(Id::lock_range), 100'000);
  jitter_q16_ = us_to_clocks_q16(values.milli(Id::lamp_jitter));
  delay_q16_ = us_to_clocks_q16(values.milli(Id::q_switch_delay));
  per_beat_q48_ = (std::int64_t{1} << 48) / beat_ticks_;
  slew_q32_ = mul_div(values.milli(Id::slew_limit), one_q32, 100'000);
  lock_edges_ = static_cast<std::uint32_t>(values.whole(Id::lock_edges));
  per_lock_q32_ = one_q32 / lock_edges_;
  set_gains(values);
  tick_q32_ = nominal_tick_q32;
  period_q16_ = nominal_q16_;
  // Ticks go on without a gap; a new beat starts here.
  ++beat_;
  origin_beat_ = beat_;
  origin_tick_ = tick_;
  tick_in_beat_ = 0;
  locked_ = mode_ != LampMode::slave;
  good_edges_ = 0;
}

void BeatClock::set_gains(const settings::Values& values) {
  // Tracking index: change of the period per beat over the jitter (uniform: / sqrt 3), Q16.
  const std::int64_t period_us = nominal_q16_ / (std::int64_t{clocks_per_us} << 16);
  const std::int64_t drift_us_e11 = values.milli(Id::lamp_drift) * period_us * period_us;
  const std::int64_t jitter_milli_us = values.milli(Id::lamp_jitter);
  // drift is in 1e-5 per second, the period in 1e-6 s: 1e11 below one us; sqrt 3 = 1.732.
  std::int64_t index_q16 =
      mul_div(drift_us_e11, 1732 * 65536 / 1000, 1000) / (jitter_milli_us * 100'000);
  index_q16 = index_q16 < 16 ? 16 : index_q16 > 65536 ? 65536 : index_q16;
  const std::int64_t root =
      isqrt(static_cast<std::uint64_t>(8 * index_q16 * 65536 + index_q16 * index_q16));
  const std::int64_t r_q16 = (4 * 65536 + index_q16 - root) / 4;
  const std::int64_t rest = 65536 - r_q16;
  phase_gain_q16_ = 65536 - ((r_q16 * r_q16) >> 16);
  period_gain_q16_ = (2 * rest * rest) >> 16;
}

EdgeInfo BeatClock::edge(std::uint64_t clock) {
  ++edges_;
  const ClockQ16 clock_q16 = clock << 16;
  if (mode_ != LampMode::slave) return nearest_beat(clock_q16);
  return locked_ ? track(clock_q16) : acquire(clock_q16);
}

EdgeInfo BeatClock::nearest_beat(ClockQ16 clock_q16) {
  // Our own trigger: the edge belongs to the beat whose lattice tick it announces.
  std::uint64_t beat = beat_;
  const std::int64_t beat_q16 = std::int64_t{beat_ticks_} * (nominal_tick_q32 >> 16);
  std::int64_t off_q16 = difference(clock_q16, clock_q16_) + delay_q16_ +
                         std::int64_t{tick_in_beat_} * (nominal_tick_q32 >> 16);
  while (off_q16 < -beat_q16 / 2) off_q16 += beat_q16, --beat;
  while (off_q16 > beat_q16 / 2) off_q16 -= beat_q16, ++beat;
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

EdgeInfo BeatClock::acquire(ClockQ16 now_q16) {
  const std::int64_t interval = difference(now_q16, last_edge_q16_);
  const EdgeInfo flash{.unlocked = true};
  const std::int64_t off = abs64(interval - nominal_q16_);
  if (good_edges_ == 0 || off > range_q16_ + 2 * jitter_q16_) {
    // A doubled edge shortens an interval: keep the older edge, start again only on a long one.
    if (good_edges_ != 0 && interval < nominal_q16_ / 2) {
      ++spurious_;
      return {};
    }
    first_edge_q16_ = last_edge_q16_ = now_q16;
    good_edges_ = 1;
    return flash;
  }
  last_edge_q16_ = now_q16;
  if (++good_edges_ > lock_edges_) lock(now_q16);
  return flash;
}

void BeatClock::lock(ClockQ16 clock_q16) {
  period_q16_ = mul_q32(difference(clock_q16, first_edge_q16_), per_lock_q32_);
  tick_q32_ = (Int128::product(period_q16_, per_beat_q48_) >> 32).to_int64();
  predicted_q16_ = clock_q16 + static_cast<ClockQ16>(period_q16_);
  predicted_beat_ = beat_;
  // Number the beats such that the lattice has the shortest way to go.
  while (lattice_error_q16() > period_q16_ / 2) ++predicted_beat_;
  while (lattice_error_q16() < -period_q16_ / 2 && predicted_beat_ > 0) --predicted_beat_;
  locked_ = true;
  strays_in_a_row_ = 0;
}

void BeatClock::lose() {
  locked_ = false;
  ++losses_;
  good_edges_ = 0;
}

EdgeInfo BeatClock::track(ClockQ16 clock_q16) {
  EdgeInfo info;
  std::int64_t error = difference(clock_q16, predicted_q16_);
  std::int64_t passed = 0;
  while (error > period_q16_ / 2 && info.missed < missed_to_loss) {
    passed += period_q16_;
    error -= period_q16_;
    ++info.missed;
  }
  // Room for the period's uncertainty over the gap, never more than a quarter beat.
  if (abs64(error) > period_q16_ / 4) {
    ++spurious_;
    if (++strays_in_a_row_ >= strays_to_loss) lose();
    return {};
  }
  strays_in_a_row_ = 0;
  info.valid = true;
  info.beat = predicted_beat_ + info.missed;
  period_q16_ += (error * period_gain_q16_) >> 16;
  if (abs64(period_q16_ - nominal_q16_) > range_q16_) {
    lose();
    return info;
  }
  tick_q32_ = (Int128::product(period_q16_, per_beat_q48_) >> 32).to_int64();
  const std::int64_t step = passed + ((error * phase_gain_q16_) >> 16) + period_q16_;
  predicted_q16_ += static_cast<ClockQ16>(step);
  predicted_beat_ = info.beat + 1;
  return info;
}

std::int64_t BeatClock::lattice_error_q16() const {
  // Where tick_ should be minus where it is: the line through the predicted edge.
  const auto beats = static_cast<std::int64_t>(beat_ - predicted_beat_);
  const std::int64_t inside = (Int128::product(tick_q32_, tick_in_beat_) >> 16).to_int64();
  return difference(predicted_q16_, clock_q16_) + delay_q16_ + beats * period_q16_ + inside;
}

bool BeatClock::settled() const {
  if (mode_ != LampMode::slave) return true;
  return locked_ && abs64(lattice_error_q16()) < settled_q16 + jitter_q16_;
}

TickSpan BeatClock::next_span(std::uint32_t max_ticks) {
  TickSpan span;
  const std::uint32_t left = beat_ticks_ - tick_in_beat_;
  span.first_tick = tick_;
  span.ticks = max_ticks < left ? max_ticks : left;
  std::int64_t length = (tick_q32_ * span.ticks) >> 16;
  if (mode_ == LampMode::slave && locked_) {
    if (beat_ > predicted_beat_ + missed_to_loss) lose();
    const std::int64_t slew = tick_ < motion_end_tick_ ? slew_q32_ : rest_slew_q32;
    const std::int64_t most = mul_q32(length, slew);
    const std::int64_t error = lattice_error_q16();
    // Never more than a quarter off nominal, however far the lamp is: boards rely on that.
    const std::int64_t nominal = (nominal_tick_q32 * span.ticks) >> 16, quarter = nominal >> 2;
    length = clamped(length + clamped(error, -most, most), nominal - quarter, nominal + quarter);
  }
  span.first_clock = clock_;
  span.clocks =
      static_cast<std::uint32_t>((static_cast<ClockQ16>(length) + (clock_q16_ & 0xffff)) >> 16);
  clock_ += span.clocks;
  clock_q16_ += static_cast<ClockQ16>(length);
  tick_ += span.ticks;
  tick_in_beat_ += span.ticks;
  if (tick_in_beat_ == beat_ticks_) {
    tick_in_beat_ = 0;
    ++beat_;
  }
  return span;
}

std::uint32_t BeatClock::shortest_tick_q16() const {
  if (mode_ != LampMode::slave) return full_tick_q16;
  const std::int64_t tick = tick_q32_ < nominal_tick_q32 ? tick_q32_ : nominal_tick_q32;
  const std::int64_t shortest = tick - mul_q32(tick, 2 * slew_q32_);
  return static_cast<std::uint32_t>((shortest >> 16) / clocks_per_tick);
}

}  // namespace lamplock::lamp
