#include "firmware/lamp/beat_clock.hpp"

#include <array>
#include <bit>
#include <cstddef>

#include "firmware/lamp/shot_delay.hpp"
#include "shared/beat.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::lamp {
namespace {

using settings::Id;
using settings::LampMode;

constexpr std::int64_t nominal_tick_q32 = std::int64_t{clocks_per_tick} << 32;
/// Maximum stretch of a tick while nothing moves: a quarter.
constexpr int rest_slew_bits = 2;
/// Edges without a beat since the last good beat, or beats without an edge, after which the lock is
/// lost.
constexpr std::uint32_t strays_to_loss = 6;
constexpr std::uint32_t missed_to_loss = 32;
/// Strays a period apart that mean a jump of the lamp.
constexpr std::uint32_t strays_to_jump = 3;
/// Beats in a row with none or several edges that mean another frequency.
constexpr std::uint32_t odd_beats_to_loss = 8;
/// Edges in a row off to the same side, by more than jitter and drift explain, that mean a jump.
constexpr std::int32_t far_off_to_jump = 3;
/// Tracking index: below the first one the gains round to nothing, above the second the tracker
/// follows the last two edges anyway.
constexpr std::int64_t least_index_q16 = 16;
constexpr std::int64_t most_index_q16 = 16 * 65536;
/// Neglected part of the distance of an edge from its prediction.
constexpr std::int64_t gate_slack_q16 = std::int64_t{2 * clocks_per_us} << 16;
/// Maximum error of the shot against the lattice tick because ticks of the delay are longer: 1 us.
constexpr std::int64_t most_delay_error_q16 = std::int64_t{clocks_per_us} << 16;
/// Look-ahead of the planner, beats, for the shortest tick.
constexpr std::int64_t planned_beats = 32;
/// The lattice has settled when it is within this and half a jitter of the lamp.
constexpr std::int64_t settled_q16 = std::int64_t{clocks_per_us} << 16;

/// A quotient, rounded, Q16.
constexpr std::int32_t ratio_q16(int numerator, int denominator) {
  return (numerator * 65536 + denominator / 2) / denominator;
}

/// Gains of the least squares line through n edges: 2 (2n - 1) / (n (n + 1)) for the phase,
/// 6 / (n (n + 1)) for the period. The index is n; the first entry in use is the second edge.
struct LineGains {
  std::int32_t phase_q16, period_q16;
};
constexpr std::uint32_t line_table_size = 18;
constexpr std::array<LineGains, line_table_size> line_table = [] {
  std::array<LineGains, line_table_size> table{};
  for (int n = 2; n < static_cast<int>(line_table_size); ++n)
    table[static_cast<std::size_t>(n)] = {ratio_q16(2 * (2 * n - 1), n * (n + 1)),
                                          ratio_q16(6, n * (n + 1))};
  return table;
}();

/// 1/n, so that an interrupt does not divide.
constexpr std::array<std::int32_t, missed_to_loss + 2> inverse_q16 = [] {
  std::array<std::int32_t, missed_to_loss + 2> table{};
  for (int n = 1; n < static_cast<int>(table.size()); ++n)
    table[static_cast<std::size_t>(n)] = ratio_q16(1, n);
  return table;
}();

/// Signed difference of two times that may have wrapped.
std::int64_t difference(std::uint64_t later_q16, std::uint64_t earlier_q16) {
  return static_cast<std::int64_t>(later_q16 - earlier_q16);
}

std::int64_t clamped(std::int64_t x, std::int64_t low, std::int64_t high) {
  return x < low ? low : x > high ? high : x;
}

/// x * f / 2^32, rounded down, for x >= 0.
[[gnu::noinline]] std::int64_t share_q32(std::int64_t x, std::uint32_t f) {
  const auto high = static_cast<std::uint32_t>(x >> 32);
  const std::uint64_t low = wide_product(static_cast<std::uint32_t>(x), f) >> 32;
  return static_cast<std::int64_t>(high == 0 ? low : low + wide_product(high, f));
}

/// x * g / 2^16 for a gain of 0..2, rounded down.
inline std::int64_t share_q16(std::int64_t x, std::int32_t gain_q16) {
  const std::uint32_t low = static_cast<std::uint32_t>(x) & 0xffff;
  const std::uint32_t low_share = (low >> 1) * static_cast<std::uint32_t>(gain_q16) >> 15;
  constexpr std::int64_t near_q16 = std::int64_t{1} << 30;  // errors of less than 131 us
  if (x >= -near_q16 && x < near_q16)
    return std::int64_t{static_cast<std::int32_t>(x >> 16) * gain_q16} + low_share;
  return (x >> 16) * gain_q16 + low_share;
}

/// Clocks of a run of ticks, Q16; limited so that a quarter more still fits 32 bits: a tick is
/// shorter than 160 clocks. Two products of 32 bits.
constexpr std::uint32_t most_run_ticks = 256;
inline std::uint32_t run_q16(std::int64_t tick_q32, std::uint32_t ticks) {
  const auto tick_q16 = static_cast<std::uint32_t>(tick_q32 >> 16);
  const std::uint32_t rest = static_cast<std::uint32_t>(tick_q32) & 0xffff;
  return tick_q16 * ticks + (rest * ticks >> 16);
}
constexpr std::uint32_t nominal_tick_q16 = nominal_tick_q32 >> 16;

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
  delay_q16_ = std::int64_t{shot_delay_clocks(values.milli(Id::q_switch_delay))} << 16;
  inverse_bits_ = static_cast<int>(std::bit_width(beat_ticks_)) - 1;
  inverse_ = static_cast<std::uint32_t>((std::uint64_t{1} << (31 + inverse_bits_)) / beat_ticks_);
  slew_q32_ = static_cast<std::uint32_t>(mul_div(values.milli(Id::slew_limit), one_q32, 100'000));
  lock_edges_ = static_cast<std::uint32_t>(values.whole(Id::lock_edges));
  set_gains(values);
  set_gates(values);
  set_longest_tick(values);
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

void BeatClock::set_least_tick(std::uint64_t from_tick, std::uint32_t tick_q16) {
  least_.set(tick_, from_tick, std::int64_t{tick_q16} * (nominal_tick_q32 >> 16));
}

std::uint32_t BeatClock::ticks_in(std::uint32_t clocks) const {
  const auto tick_q16 = static_cast<std::uint32_t>(tick_q32_ >> 16);
  return static_cast<std::uint32_t>(((std::uint64_t{clocks} << 16) + tick_q16 / 2) / tick_q16);
}

void BeatClock::set_tick_length(std::uint64_t from_tick, std::uint32_t tick_q16) {
  if (mode_ != LampMode::master) return;
  const std::int64_t spread = longest_tick_q16_ - full_tick_q16;
  const std::int64_t length = clamped(tick_q16, full_tick_q16 - spread, full_tick_q16 + spread);
  length_.set(tick_, from_tick, length * (nominal_tick_q32 >> 16));
}

void BeatClock::set_longest_tick(const settings::Values& values) {
  longest_tick_q16_ = full_tick_q16;
  if (mode_ != LampMode::master) return;
  std::int64_t spread_q16 = mul_div(values.milli(Id::period_tolerance), 65536, 100'000);
  const std::int64_t by_delay_q16 = (most_delay_error_q16 << 16) / delay_q16_;
  if (spread_q16 > by_delay_q16) spread_q16 = by_delay_q16;
  longest_tick_q16_ = full_tick_q16 + static_cast<std::uint32_t>(spread_q16);
}

void BeatClock::set_gains(const settings::Values& values) {
  // Tracking index: change of the period per beat over the jitter (uniform: / sqrt 3), Q16.
  const std::int64_t period_us = nominal_q16_ / (std::int64_t{clocks_per_us} << 16);
  const std::int64_t drift_us_e11 = values.milli(Id::lamp_drift) * period_us * period_us;
  const std::int64_t jitter_milli_us = values.milli(Id::lamp_jitter);
  // drift is in 1e-5 per second, the period in 1e-6 s: 1e11 below one us; sqrt 3 = 1.732.
  std::int64_t index_q16 =
      mul_div(drift_us_e11, 1732 * 65536 / 1000, 1000) / (jitter_milli_us * 100'000);
  index_q16 = clamped(index_q16, least_index_q16, most_index_q16);
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

EdgeInfo BeatClock::edge(std::uint64_t clock) {
  ++edges_;
  const ClockQ16 clock_q16 = clock << 16;
  if (mode_ != LampMode::slave) {
    silent_beats_ = 0;
    locked_ = true;
    return nearest_beat(clock_q16);
  }
  return locked_ ? track(clock_q16) : acquire(clock_q16);
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

/// Sets the gains after this number of edges of a line.
void BeatClock::set_line(std::uint32_t edges) {
  line_edges_ = edges;
  line_ = edges < 2 ? Gains{65536, 65536}
                    : Gains{line_table[edges].phase_q16, line_table[edges].period_q16};
  choose_gains();
}

void BeatClock::choose_gains() {
  gains_ = {line_.phase_q16 > steady_.phase_q16 ? line_.phase_q16 : steady_.phase_q16,
            line_.period_q16 > steady_.period_q16 ? line_.period_q16 : steady_.period_q16};
  uncertain_q16_ = share_q16(
      jitter_q16_, gains_.phase_q16 > gains_.period_q16 ? gains_.phase_q16 : gains_.period_q16);
}

void BeatClock::next_gains() {
  if (line_edges_ + 1 < line_table_size) {
    set_line(line_edges_ + 1);
    return;
  }
  // The gains only fall: below the steady ones they are no longer used.
  if (line_.phase_q16 <= steady_.phase_q16 && line_.period_q16 <= steady_.period_q16) return;
  // With g = 4/n the next one is 4/(n+1) = g - g^2/4 + ..., and 6/n^2 = 3 g^2 / 8.
  const std::int32_t square_q16 = (line_.phase_q16 * line_.phase_q16) >> 16;
  line_ = {line_.phase_q16 - (square_q16 >> 2), (3 * square_q16) >> 3};
  choose_gains();
}

/// Maximum distance of an edge from its prediction. The weights of the past edges in a prediction
/// add up to at most 3 (the line through two), those of the period per beat to less than 1/2 from
/// the fifth edge on; the edge itself adds its own jitter.
std::int64_t BeatClock::gate_q16(std::uint32_t missed) const {
  const std::int64_t beats = std::int64_t{missed} + 1;
  return 4 * jitter_q16_ + beats * jitter_q16_ / 2 + beats * beats * innovation_q16_ +
         gate_slack_q16;
}

bool BeatClock::near_nominal(std::int64_t interval_q16, std::int64_t slack_q16) const {
  return abs64(interval_q16 - nominal_q16_) <= range_q16_ + slack_q16;
}

bool BeatClock::outside_range() const { return !near_nominal(period_q16_, uncertain_q16_); }

void BeatClock::start_line(ClockQ16 now) {
  last_edge_q16_ = now;
  good_edges_ = 1;
  set_line(1);
  crowded_ = false;
}

void BeatClock::draw_line(ClockQ16 now, std::int64_t period_q16, std::uint32_t edges) {
  period_q16_ = period_q16;
  predicted_q16_ = now + static_cast<ClockQ16>(period_q16);
  edge_before_q16_ = now - static_cast<ClockQ16>(period_q16);
  last_edge_q16_ = now;
  good_edges_ = edges;
  set_line(edges);
}

EdgeInfo BeatClock::acquire(ClockQ16 now) {
  const EdgeInfo flash{.unlocked = true};
  const std::int64_t interval = difference(now, last_edge_q16_);
  if (good_edges_ > 1) {
    const std::int64_t error = difference(now, predicted_q16_);
    const std::int64_t gate = gate_q16_, quarter = period_q16_ / 4;
    if (abs64(error) <= (gate < quarter ? gate : quarter)) {
      next_gains();
      follow(error, 0);
      edge_before_q16_ = last_edge_q16_;
      last_edge_q16_ = now;
      if (outside_range())
        start_line(now);
      else if (++good_edges_ > lock_edges_)
        lock();
      return flash;
    }
    // One edge in the middle of a beat is a fault, two are another rhythm.
    if (error < 0 && (interval < quarter || !crowded_)) {
      crowded_ = crowded_ || interval >= quarter;
      ++spurious_;
      return {};
    }
  }
  if (good_edges_ != 0 && near_nominal(interval, 2 * jitter_q16_)) {
    draw_line(now, interval, 2);
    return flash;
  }
  // A doubled edge shortens an interval: keep the older edge, start again only on a long one.
  if (good_edges_ == 1 && interval < nominal_q16_ / 2) {
    ++spurious_;
    return {};
  }
  start_line(now);
  return flash;
}

void BeatClock::lock() {
  tick_q32_ = tick_of_period_q32(period_q16_);
  predicted_beat_ = beat_;
  aim();
  // Number the beats so that the lattice needs the smallest correction.
  std::int64_t error = lattice_error_q16();
  for (; error > period_q16_ / 2; error -= period_q16_) ++predicted_beat_;
  for (; error < -period_q16_ / 2 && predicted_beat_ > 0; error += period_q16_) --predicted_beat_;
  aim();
  locked_ = true;
  on_lamp_ = false;
  strays_in_a_row_ = stray_rhythm_ = odd_beats_ = 0;
  far_off_ = 0;
  crowded_ = false;
}

void BeatClock::lose() {
  locked_ = false;
  ++losses_;
  good_edges_ = line_edges_ = 0;
  crowded_ = false;
}

EdgeInfo BeatClock::track(ClockQ16 now) {
  EdgeInfo info;
  std::int64_t error = difference(now, predicted_q16_);
  while (error > period_q16_ / 2 && info.missed < missed_to_loss) {
    error -= period_q16_;
    ++info.missed;
  }
  // At most a quarter beat; a lamp slightly worse than its settings is tolerated.
  const std::int64_t expected = info.missed == 0 ? gate_q16_ : gate_q16(info.missed);
  std::int64_t gate = expected;
  if (gate < period_q16_ >> 5) gate = period_q16_ >> 5;
  if (gate > period_q16_ >> 2) gate = period_q16_ >> 2;
  if (abs64(error) > gate) return stray(now, error);
  info.valid = true;
  info.beat = predicted_beat_ + info.missed;
  predicted_beat_ = info.beat + 1;
  stray_rhythm_ = 0;
  ++odd_beats_;
  // One edge in one beat, the normal case.
  if (!crowded_ && info.missed == 0) strays_in_a_row_ = odd_beats_ = 0;
  crowded_ = false;
  follow_jump(now, error, info.missed, expected);
  if (outside_range() || odd_beats_ >= odd_beats_to_loss) {
    lose();
    return info;
  }
  tick_q32_ = tick_of_period_q32(period_q16_);
  aim();
  return info;
}

EdgeInfo BeatClock::stray(ClockQ16 now, std::int64_t error) {
  ++spurious_;
  if (abs64(error) > period_q16_ / 4) crowded_ = true;
  const std::int64_t interval = difference(now, last_stray_q16_);
  if (stray_rhythm_ != 0 && near_nominal(interval, 2 * jitter_q16_)) {
    ++stray_rhythm_;
    last_stray_q16_ = now;
  } else if (stray_rhythm_ == 0 || interval > nominal_q16_ / 2) {
    stray_rhythm_ = 1;
    first_stray_q16_ = last_stray_q16_ = now;
  }
  if (stray_rhythm_ >= strays_to_jump) {
    lose();
    draw_line(now, difference(now, first_stray_q16_) / 2, strays_to_jump);
    return {.missed = strays_to_jump - 1, .unlocked = true};
  }
  if (++strays_in_a_row_ >= strays_to_loss) lose();
  return {};
}

/// Handles edges that stay off to one side, a jump inside the gate: a new line through the last
/// three. `gate` is that for `missed` beats.
void BeatClock::follow_jump(ClockQ16 now, std::int64_t error, std::uint32_t missed,
                            std::int64_t gate) {
  if (missed != 0 || abs64(error) <= gate)
    far_off_ = 0;
  else if (error > 0)
    far_off_ = far_off_ > 0 ? far_off_ + 1 : 1;
  else
    far_off_ = far_off_ < 0 ? far_off_ - 1 : -1;
  if (far_off_ >= far_off_to_jump || far_off_ <= -far_off_to_jump) {
    const std::int64_t period = difference(now, edge_before_q16_) / 2;
    if (near_nominal(period, jitter_q16_)) {
      draw_line(now, period, far_off_to_jump);
      far_off_ = 0;
      return;
    }
  }
  // An outlier, such as a second edge just before the next first one, must not disturb the tracker.
  next_gains();
  follow(clamped(error, -gate, gate), missed);
  edge_before_q16_ = last_edge_q16_;
  last_edge_q16_ = now;
}

void BeatClock::follow(std::int64_t error, std::uint32_t missed) {
  if (missed == 0) {
    period_q16_ += share_q16(error, gains_.period_q16);
    predicted_q16_ += static_cast<ClockQ16>(share_q16(error, gains_.phase_q16) + period_q16_);
    return;
  }
  // Over a gap of several beats an error of the period accumulates, one of the phase does not.
  const auto beats = static_cast<std::int32_t>(missed) + 1;
  std::int32_t phase_q16 = gains_.phase_q16 * beats;
  if (phase_q16 > 65536) phase_q16 = 65536;
  const std::int64_t passed = period_q16_ * missed;
  period_q16_ += share_q16(share_q16(error, gains_.period_q16), inverse_q16[missed + 1]);
  predicted_q16_ += static_cast<ClockQ16>(passed + share_q16(error, phase_q16) + period_q16_);
}

std::int64_t BeatClock::tick_of_period_q32(std::int64_t period_q16) const {
  // period 2^16 / N = period inverse / 2^(15 + bits): 2^32 of it in the product.
  const int left = 17 - inverse_bits_;
  return share_q32(left >= 0 ? period_q16 << left : period_q16 >> -left, inverse_);
}

/// The line through the predicted edge, at the beginning of the present beat and at tick_.
void BeatClock::aim() {
  const auto beats = static_cast<std::int64_t>(beat_ - predicted_beat_);
  beat_aim_q16_ = predicted_q16_ + static_cast<ClockQ16>(delay_q16_) +
                  static_cast<ClockQ16>(beats * period_q16_);
  aim_q16_ = beat_aim_q16_ + static_cast<ClockQ16>((tick_q32_ * tick_in_beat_) >> 16);
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
  const std::uint32_t least = run_q16(least_.most(tick_, tick_ + ticks + lead_ticks_), ticks);
  return length < least ? least : length;
}

TickSpan BeatClock::next_span(std::uint32_t max_ticks) {
  const std::uint32_t left = beat_ticks_ - tick_in_beat_;
  std::uint32_t run = max_ticks < left ? max_ticks : left;
  // Longer than boards request: all runs equal.
  int fold = 0;
  for (; run > most_run_ticks; run >>= 1) ++fold;
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

std::uint32_t BeatClock::shortest_tick_q16() const {
  if (mode_ != LampMode::slave) return full_tick_q16;
  const std::int64_t tick = tick_q32_ < nominal_tick_q32 ? tick_q32_ : nominal_tick_q32;
  // The change of the lamp until the plan has been run, at least another slew; but the period stays
  // inside its range.
  constexpr std::int64_t all_q32 = 0xffffffff;
  const auto drift_q32 =
      static_cast<std::uint32_t>(clamped(planned_beats * drift_q32_, slew_q32_, all_q32));
  const std::int64_t shortest = tick - share_q32(tick, slew_q32_) - share_q32(tick, drift_q32);
  const std::int64_t range_end = tick_of_period_q32(nominal_q16_ - range_q16_);
  const std::int64_t floor = range_end - share_q32(range_end, slew_q32_);
  return static_cast<std::uint32_t>(((shortest > floor ? shortest : floor) >> 16) /
                                    clocks_per_tick);
}

}  // namespace lamplock::lamp
