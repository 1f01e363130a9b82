// Calculates the gains, gates and limits of the beat clock from the settings (main loop: divides).
#include <bit>

#include "firmware/lamp/beat_clock.hpp"
#include "firmware/lamp/clock_arithmetic.hpp"
#include "firmware/lamp/shot_delay.hpp"
#include "shared/beat.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::lamp {
namespace {

using settings::Id;
using settings::LampMode;

/// Tracking index: below the first one the gains round to nothing, above the second the tracker
/// follows the last two edges anyway.
constexpr std::int64_t min_index_q16 = 16;
constexpr std::int64_t max_index_q16 = 16 * 65536;
/// Maximum error of the shot against the lattice tick because ticks of the delay are longer: 1 us.
constexpr std::int64_t max_delay_error_q16 = std::int64_t{clocks_per_us} << 16;
/// Share of the slew limit by which ticks may be shorter than the tracked tick. Limits of motion
/// are made for the shortest tick, so this share costs speed; corrections of jitter are far
/// smaller.
constexpr std::uint32_t shrink_part = 8;
/// The shortest tick changes in steps of this share of the nominal one, so that a lamp with jitter
/// gives the same limits every time. The nominal tick is in the middle of a step.
constexpr std::int64_t step_q32 = nominal_tick_q32 / 8192;

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
  const std::uint32_t delay_clocks = shot_delay_clocks(values.milli(Id::q_switch_delay));
  delay_q16_ = std::int64_t{delay_clocks} << 16;
  delay_ticks_ = delay_clocks / clocks_per_tick;
  inverse_bits_ = static_cast<int>(std::bit_width(beat_ticks_)) - 1;
  inverse_ = static_cast<std::uint32_t>((std::uint64_t{1} << (31 + inverse_bits_)) / beat_ticks_);
  slew_q32_ = static_cast<std::uint32_t>(mul_div(values.milli(Id::slew_limit), one_q32, 100'000));
  lock_edges_ = static_cast<std::uint32_t>(values.whole(Id::lock_edges));
  set_gains(values);
  set_gates(values);
  set_max_tick(values);
  length_.reset(nominal_tick_q32);
  tick_q32_ = nominal_tick_q32;
  period_q16_ = nominal_q16_;
  // Ticks continue without a gap; a new beat starts here.
  ++beat_;
  origin_beat_ = beat_;
  origin_tick_ = tick_;
  tick_in_beat_ = 0;
  locked_ = mode_ != LampMode::slave;
  silent_beats_ = 0;
  good_edges_ = line_edges_ = 0;
}

void BeatClock::set_max_tick(const settings::Values& values) {
  max_tick_q16_ = full_tick_q16;
  if (mode_ != LampMode::master) return;
  std::int64_t spread_q16 = mul_div(values.milli(Id::period_tolerance), 65536, 100'000);
  const std::int64_t by_delay_q16 = (max_delay_error_q16 << 16) / delay_q16_;
  if (spread_q16 > by_delay_q16) spread_q16 = by_delay_q16;
  max_tick_q16_ = full_tick_q16 + static_cast<std::uint32_t>(spread_q16);
}

void BeatClock::set_gains(const settings::Values& values) {
  // Tracking index: change of the period per beat over the jitter (uniform: / sqrt 3), Q16.
  const std::int64_t period_us = nominal_q16_ / (std::int64_t{clocks_per_us} << 16);
  const std::int64_t drift_us_e11 = values.milli(Id::lamp_drift) * period_us * period_us;
  const std::int64_t jitter_milli_us = values.milli(Id::lamp_jitter);
  // drift is in 1e-5 per second, the period in 1e-6 s: 1e11 below one us; sqrt 3 = 1.732.
  std::int64_t index_q16 =
      mul_div(drift_us_e11, 1732 * 65536 / 1000, 1000) / (jitter_milli_us * 100'000);
  index_q16 = clamped(index_q16, min_index_q16, max_index_q16);
  const std::int64_t root =
      isqrt(static_cast<std::uint64_t>(8 * index_q16 * 65536 + index_q16 * index_q16));
  const std::int64_t r_q16 = (4 * 65536 + index_q16 - root) / 4;
  const std::int64_t rest = 65536 - r_q16;
  steady_ = {static_cast<std::int32_t>(65536 - ((r_q16 * r_q16) >> 16)),
             static_cast<std::int32_t>((2 * rest * rest) >> 16)};
}

void BeatClock::set_gates(const settings::Values& values) {
  // Drift per beat as a share of the period: %/s over Hz, in thousandths of both.
  drift_q32_ = mul_div(values.milli(Id::lamp_drift), one_q32,
                       100 * static_cast<std::uint32_t>(values.milli(Id::lamp_frequency)));
  // The period grows by c a beat; the tracker follows when it corrects as much: gain * error = c.
  // A line through two edges is off by c, and again when the drift reverses.
  const std::int64_t change_q16 = mul_q32(nominal_q16_, drift_q32_);
  const std::int64_t steady_error_q16 =
      mul_div(change_q16, 65536, static_cast<std::uint32_t>(steady_.period_q16));
  innovation_q16_ = steady_error_q16 > 2 * change_q16 ? steady_error_q16 : 2 * change_q16;
  gate_q16_ = gate_q16(0);
}

std::uint32_t BeatClock::min_tick_q16(std::uint32_t ticks) const {
  if (mode_ != LampMode::slave) return full_tick_q16;
  const std::uint32_t shrink_q32 = slew_q32_ / shrink_part;
  const std::int64_t tick = (tick_q32_ + step_q32 / 2) / step_q32 * step_q32 - step_q32 / 2;
  constexpr std::int64_t all_q32 = 0xffffffff;
  const auto drift_q32 =
      static_cast<std::uint32_t>(clamped(mul_div(drift_q32_, ticks, beat_ticks_), 0, all_q32));
  const std::int64_t shortest = tick - share_q32(tick, shrink_q32) - share_q32(tick, drift_q32);
  // The period stays inside its range.
  const std::int64_t range_end = tick_of_period_q32(nominal_q16_ - range_q16_);
  const std::int64_t floor = range_end - share_q32(range_end, shrink_q32);
  return static_cast<std::uint32_t>(((shortest > floor ? shortest : floor) >> 16) /
                                    clocks_per_tick);
}

}  // namespace lamplock::lamp
