#include "firmware/stepper/beam_axis.hpp"

#include <bit>

#include "shared/fixed_point.hpp"

namespace lamplock::stepper {
namespace {

constexpr std::uint32_t forever = 0xffffffffu;
/// Edges that follow each other faster are handled together.
constexpr std::uint32_t min_cell_ticks = 32;
/// The longest run that is searched at once: the squares of its ticks fit.
constexpr std::uint32_t max_ticks = 0x1fff;

constexpr int place_bits = 48;
constexpr std::int64_t one_q48 = std::int64_t{1} << place_bits;
constexpr std::uint64_t fraction_mask = (std::uint64_t{1} << place_bits) - 1;
constexpr std::uint32_t full_power = 65535;

enum Phase : std::uint8_t { lead, cruise, tail };

std::uint64_t shifted(std::uint64_t value, int right) {
  return right >= 64 ? 0 : right >= 0 ? value >> right : value << -right;
}

}  // namespace

void BeamAxis::enter(const Segment& segment) {
  if (kind_ == BeamKind::even) since_edge_ = min_cell_ticks;
  const bool cells = segment.shines && segment.beam_kind != BeamKind::at_rest;
  kind_ = cells ? segment.beam_kind : BeamKind::even;
  if (kind_ != BeamKind::pulses) pulse_left_ = 0;
  if (kind_ == BeamKind::even) return;
  segment_ = &segment;
  const AxisProfile& axis = segment.axis[index(segment.beam_axis)];
  const std::int64_t accel_q62 = axis.lead_ticks != 0 ? axis.lead_accel_q62 : axis.tail_accel_q62;
  backwards_ = axis.speed_q62 < 0 || (axis.speed_q62 == 0 && accel_q62 < 0);
  speed_q62_ = axis.speed_q62;
  phase_ = lead;
  stair_ = static_cast<std::uint8_t>(first_stair(axis.lead_ramp));
  if (kind_ == BeamKind::pulses)
    enter_pulses();
  else
    enter_pixels();
  next_piece();
  find_edge();
}

void BeamAxis::enter_pixels() {
  const SegmentBeam& beam = segment_->beam;
  place_q48_ = std::uint64_t{beam.place} << (place_bits - pixel_place_bits);
  if (!listed_ || beam.list != list_) {
    listed_ = true;
    list_ = beam.list;
    cells_ = table_.cells(list_);
    run_ = list_;  // the header has no cells
    run_end_ = 0;
  }
  seek(static_cast<std::uint32_t>(place_q48_ >> place_bits));
}

void BeamAxis::enter_pulses() {
  const SegmentBeam& beam = segment_->beam;
  place_q48_ = std::uint64_t{beam.place} << (place_bits - pulse_place_bits);
  power_ = beam.power;
  const auto edges = static_cast<std::uint8_t>(place_q48_ >> place_bits);
  // A rounding moved this edge here from the previous segment.
  const bool missed = static_cast<std::uint8_t>(edges - edges_) == 1;
  if (segment_->beam_begins) {
    edges_ = edges;
    pulse_left_ = 0;
  } else if (missed && since_edge_ >= min_cell_ticks) {
    edges_ = edges;
    since_edge_ = 0;
    begin_pulse();
  }
}

/// Converts steps of the axis to cells, times 2^-14; rounded towards zero.
std::int64_t BeamAxis::in_cells_q48(std::int64_t steps_q62) const {
  constexpr int mantissa_bits = 24;
  const std::uint32_t ratio = segment_->beam.ratio;
  const std::uint32_t mantissa = ratio >> (32 - mantissa_bits);
  const int right = static_cast<int>(ratio & 0xffu) + 62 - place_bits;
  const bool negative = (steps_q62 < 0) != backwards_;
  const auto steps = static_cast<std::uint64_t>(abs64(steps_q62));
  const std::uint64_t low = wide_product(static_cast<std::uint32_t>(steps), mantissa);
  const std::uint64_t high = wide_product(static_cast<std::uint32_t>(steps >> 32), mantissa);
  const std::uint64_t upper = high + (low >> 32);
  const auto cells = static_cast<std::int64_t>(right >= 32 ? shifted(upper, right - 32)
                                                           : (upper << (32 - right)) +
                                                                 ((low & 0xffffffffu) >> right));
  return negative ? -cells : cells;
}

/// The next stretch of constant acceleration; false after the last.
bool BeamAxis::next_piece() {
  const AxisProfile& p = segment_->axis[index(segment_->beam_axis)];
  for (;; ++phase_) {
    Stair stair;
    const bool in_lead = phase_ == lead;
    const std::uint32_t ticks = in_lead            ? p.lead_ticks
                                : phase_ == cruise ? p.cruise_ticks
                                                   : p.tail_ticks;
    const std::int64_t accel_q62 = in_lead            ? p.lead_accel_q62
                                   : phase_ == cruise ? 0
                                                      : p.tail_accel_q62;
    const std::uint8_t ramp = in_lead            ? p.lead_ramp
                              : phase_ == cruise ? std::uint8_t{0}
                                                 : p.tail_ramp;
    while (ticks != 0 && next_stair(accel_q62, ticks, ramp, stair_, stair)) {
      ++stair_;
      if (stair.ticks == 0) continue;
      // The rate is the speed in the middle of a tick.
      const std::int64_t rate_q48 = in_cells_q48(speed_q62_ + stair.accel_q62 / 2);
      rate_q48_ = rate_q48 > one_q48 ? one_q48 : rate_q48;
      accel_q48_ = in_cells_q48(stair.accel_q62);
      piece_left_ = stair.ticks;
      speed_q62_ += stair.accel_q62 * static_cast<std::int64_t>(stair.ticks);
      return true;
    }
    if (phase_ == tail) break;
    stair_ =
        static_cast<std::uint8_t>(first_stair(phase_ == cruise ? p.tail_ramp : std::uint8_t{0}));
  }
  rate_q48_ = accel_q48_ = 0;
  piece_left_ = forever;
  return false;
}

/// n r + n (n - 1) / 2 a, n at most max_ticks.
std::int64_t BeamAxis::way_q48(std::uint32_t n) const {
  if (n == 0) return 0;
  const std::int64_t way = times_short(rate_q48_, n);
  return accel_q48_ == 0 ? way : way + times_short(times_short(accel_q48_, n), n - 1) / 2;
}

/// The first tick count after which this distance is covered; it is at most `most`. Bit by bit:
/// over 2^k ticks from rate r the distance is r 2^k + a (4^k - 2^k) / 2, and r grows by a 2^k.
std::uint32_t BeamAxis::ticks_to_q48(std::int64_t way_q48, std::uint32_t most) const {
  int k = static_cast<int>(std::bit_width(most)) - 1;
  std::int64_t rates = rate_q48_ * (std::int64_t{1} << k);
  std::int64_t growth = accel_q48_ * (std::int64_t{1} << k);
  std::int64_t square = growth * (std::int64_t{1} << k);
  std::uint32_t ticks = 0;
  for (;; --k) {
    const std::int64_t way = rates + ((square - growth) >> 1);
    if (way < way_q48 && ticks + (1u << k) < most) {
      way_q48 -= way;
      ticks += 1u << k;
      rates += square;
    }
    if (k == 0) return ticks + 1;
    rates >>= 1;
    growth >>= 1;
    square >>= 2;
  }
}

/// Finds for how many ticks nothing changes, and whether an edge ends them.
void BeamAxis::find_edge() {
  const std::uint32_t most = piece_left_ < max_ticks ? piece_left_ : max_ticks;
  const auto to_edge = static_cast<std::int64_t>(one_q48 - (place_q48_ & fraction_mask));
  edge_ = way_q48(most) >= to_edge;
  span_ = edge_ ? ticks_to_q48(to_edge, most) : most;
  if (edge_ && since_edge_ + span_ < min_cell_ticks) {
    span_ = min_cell_ticks - since_edge_;
    if (span_ > most) span_ = most, edge_ = false;  // the edge is handled with the next one
  }
  left_ = span_;
}

/// At the end of a span.
void BeamAxis::change() {
  const std::uint64_t before = place_q48_;
  const std::int64_t way = way_q48(span_);
  if (way > 0) place_q48_ += static_cast<std::uint64_t>(way);
  if (kind_ == BeamKind::pulses) place_q48_ &= (std::uint64_t{1} << (place_bits + 8)) - 1;
  rate_q48_ += times_short(accel_q48_, span_);
  if (piece_left_ != forever) piece_left_ -= span_;
  since_edge_ += span_;
  if (since_edge_ > min_cell_ticks) since_edge_ = min_cell_ticks;
  const bool passed = before >> place_bits != place_q48_ >> place_bits;
  if (edge_ || (passed && since_edge_ == min_cell_ticks)) pass_edge();
  if (piece_left_ == 0) next_piece();
  find_edge();
}

void BeamAxis::pass_edge() {
  since_edge_ = 0;
  const auto number = static_cast<std::uint32_t>(place_q48_ >> place_bits);
  if (kind_ != BeamKind::pulses) return seek(number);
  const auto edges = static_cast<std::uint8_t>(number);
  // An edge that the previous segment has passed begins no second pulse.
  if (static_cast<std::int8_t>(edges - edges_) > 0) begin_pulse();
  edges_ = edges;
}

void BeamAxis::begin_pulse() {
  if (pulse_left_ != 0) ++merged_;
  pulse_left_ = pulse_ticks_;
}

/// Advances to the run that contains a cell, never back. After the last cell its power continues.
void BeamAxis::seek(std::uint32_t cell) {
  const std::uint32_t wanted = cell < cells_ ? cell : cells_ - 1;
  if (wanted < run_end_) return;
  std::uint16_t run = 0;
  while (run_end_ <= wanted) {
    ++run_;
    run = table_.run(run_);
    run_end_ += wire::run_cells(run);
  }
  table_.release(run_);
  const std::uint32_t power = (wire::run_power(run) * percent_q14_) >> percent_bits;
  power_ = static_cast<std::uint16_t>(power < full_power ? power : full_power);
}

/// In M4 power is P r C, with the rate r and the C ticks that a cell takes at the feed rate: it
/// changes as evenly as the speed does.
PowerStretch BeamAxis::stretch() const {
  const std::uint32_t left = left_;
  if (kind_ != BeamKind::pixels_by_speed) return {std::uint32_t{power_} << 16, 0, left};
  constexpr std::uint64_t full_q16 = std::uint64_t{full_power} << 16;
  const CellTicks cell_ticks(segment_->beam.cell_ticks);
  const std::uint32_t scaled = std::uint32_t{power_} * cell_ticks.mantissa();
  const int right = place_bits - 16 - cell_ticks.exponent();
  const std::int64_t rate_q48 = rate_q48_ + times_short(accel_q48_, span_ - left);
  if (rate_q48 <= 0) return {0, 0, left};
  const std::uint64_t power_q16 =
      shifted(std::uint64_t{scaled} * (static_cast<std::uint64_t>(rate_q48) >> 16), right - 16);
  if (power_q16 >= full_q16) return {static_cast<std::uint32_t>(full_q16), 0, left};
  // A product of at most 63 bits, however steep the slope is.
  const auto accel_q48 = static_cast<std::uint64_t>(abs64(accel_q48_));
  const int dropped = accel_q48 >> 35 != 0 ? 16 : 0;
  auto slope_q16 = static_cast<std::int64_t>(
      shifted(std::uint64_t{scaled} * (accel_q48 >> dropped), right - dropped));
  // A falling power is less than one bit too high: it may reach 0 in the last tick, but not less.
  if (accel_q48_ < 0 && slope_q16 != 0) slope_q16 = 1 - slope_q16;
  const std::int64_t end =
      static_cast<std::int64_t>(power_q16) + slope_q16 * (std::int64_t{left} - 1);
  if (end < 0) return {0, 0, left};
  if (end > static_cast<std::int64_t>(full_q16)) slope_q16 = 0;
  return {static_cast<std::uint32_t>(power_q16), static_cast<std::uint32_t>(slope_q16), left};
}

}  // namespace lamplock::stepper
