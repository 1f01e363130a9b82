// Edges of LAMP SYNC: which beat each belongs to, the tracker of phase and period, lock and loss.
#include <array>
#include <cstddef>

#include "firmware/lamp/beat_clock.hpp"
#include "firmware/lamp/clock_arithmetic.hpp"

namespace lamplock::lamp {
namespace {

using settings::LampMode;

/// Edges without a beat since the last good beat after which the lock is lost.
constexpr std::uint32_t strays_to_loss = 6;
/// Strays a period apart that mean a jump of the lamp.
constexpr std::uint32_t strays_to_jump = 3;
/// Beats in a row with none or several edges that mean another frequency.
constexpr std::uint32_t odd_beats_to_loss = 8;
/// Edges in a row off to the same side, by more than jitter and drift explain, that mean a jump.
constexpr std::int32_t far_off_to_jump = 3;
/// Neglected part of the distance of an edge from its prediction.
constexpr std::int64_t gate_slack_q16 = std::int64_t{2 * clocks_per_us} << 16;

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

/// x * g / 2^16 for a gain of 0..2, rounded down.
inline std::int64_t share_q16(std::int64_t x, std::int32_t gain_q16) {
  const std::uint32_t low = static_cast<std::uint32_t>(x) & 0xffff;
  const std::uint32_t low_share = (low >> 1) * static_cast<std::uint32_t>(gain_q16) >> 15;
  constexpr std::int64_t near_q16 = std::int64_t{1} << 30;  // errors of less than 131 us
  if (x >= -near_q16 && x < near_q16)
    return std::int64_t{static_cast<std::int32_t>(x >> 16) * gain_q16} + low_share;
  return (x >> 16) * gain_q16 + low_share;
}

}  // namespace

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

}  // namespace lamplock::lamp
