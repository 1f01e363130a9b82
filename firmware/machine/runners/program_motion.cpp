#include "firmware/machine/runners/program_motion.hpp"

namespace lamplock::machine {
namespace {

using motion::full_power;
using program::Spindle;
using settings::Id;

/// 10^-7 mm times thousandths of steps/mm.
constexpr std::int64_t per_step = program::one_e7 * 1000;
constexpr std::int64_t max_product =
    program::max_position_e7 * settings::range(Id::steps_per_mm_x).max_milli;
static_assert(max_product / per_step < max_position_steps);

/// 10^10 = 2^10 5^10: without a division instruction a divisor of 24 bits costs half as much.
constexpr std::uint32_t per_step_units = 9'765'625;
static_assert(per_step == std::int64_t{per_step_units} << 10);

/// n / per_step_units by a product: exact while n times the excess of the reciprocal, less than a
/// divisor, stays below 2^55.
constexpr int reciprocal_bits = 55;
constexpr std::uint64_t reciprocal = (std::uint64_t{1} << reciprocal_bits) / per_step_units + 1;
static_assert(reciprocal >> 32 == 0);
constexpr std::uint32_t max_dividend = (per_step_units << motion::place_bits) + per_step_units / 2;
static_assert(std::uint64_t{max_dividend} * per_step_units < std::uint64_t{1} << reciprocal_bits);

/// units / per_step_units for the units of a position: estimated from their upper 32 bits by the
/// reciprocal, at most one too low.
constexpr int dropped_bits = 21;
constexpr std::uint64_t max_units = (static_cast<std::uint64_t>(max_product) + per_step) >> 10;
static_assert(max_units >> dropped_bits >> 32 == 0);
[[gnu::hot]] std::uint32_t whole_steps(std::uint64_t units) {
  const auto top = static_cast<std::uint32_t>(units >> dropped_bits);
  const auto low =
      static_cast<std::uint32_t>(wide_product(top, static_cast<std::uint32_t>(reciprocal - 1)) >>
                                 (reciprocal_bits - dropped_bits));
  const std::uint32_t rest = static_cast<std::uint32_t>(units) - low * per_step_units;
  return rest < per_step_units ? low : low + 1;
}

/// Distance from the middle of a step to `units` above its lower edge.
[[gnu::hot]] int off_q8(std::uint32_t units) {
  using motion::max_off_q8, motion::place_bits;
  const std::uint32_t dividend = (units << place_bits) + per_step_units / 2;
  const auto from_edge = static_cast<std::uint32_t>(
      wide_product(dividend, static_cast<std::uint32_t>(reciprocal)) >> reciprocal_bits);
  const int off = static_cast<int>(from_edge) - (1 << (place_bits - 1));
  return off > max_off_q8 ? max_off_q8 : off < -max_off_q8 ? -max_off_q8 : off;
}

motion::LinePower laser_of(const program::Action& move) {
  switch (move.spindle) {
    case Spindle::constant:
      return motion::LinePower::constant;
    case Spindle::proportional:
      return motion::LinePower::proportional;
    default:
      return motion::LinePower::off;
  }
}

}  // namespace

[[gnu::hot]] void find_place(const program::Place& place_e7, const settings::Values& values,
                             motion::LinePlace& place) {
  for (int a = 0; a < values.whole(Id::axes); ++a) {
    const std::int64_t product = place_e7[index(a)] * values.milli(Id::steps_per_mm_x, a);
    const std::uint64_t magnitude = static_cast<std::uint64_t>(product < 0 ? -product : product);
    const std::uint64_t units = (magnitude + per_step / 2) >> 10;
    const auto step = static_cast<std::int32_t>(whole_steps(units));
    const int off = off_q8(static_cast<std::uint32_t>(units) -
                           static_cast<std::uint32_t>(step) * per_step_units);
    place.steps[index(a)] = product < 0 ? -step : step;
    place.off_q8[index(a)] = static_cast<std::int8_t>(product < 0 ? -off : off);
  }
  for (int a = values.whole(Id::axes); a < max_axes; ++a) {
    place.steps[index(a)] = 0;
    place.off_q8[index(a)] = 0;
  }
  if (values.milli(Id::kinematics) != 0) motion::keep_in_motor_steps(place);
}

StepPosition steps_of(const program::Place& place_e7, const settings::Values& values) {
  motion::LinePlace place;
  find_place(place_e7, values, place);
  return place.steps;
}

std::int64_t place_of(std::int32_t step, const settings::Values& values, int axis) {
  return step * per_step / values.milli(Id::steps_per_mm_x, axis);
}

std::int64_t place_of(const stepper::AxisState& axis, const settings::Values& values, int a) {
  const bool on_edge = axis.position_q64.lo() == 0;
  const std::int64_t half_step = on_edge ? per_step / 2 / values.milli(Id::steps_per_mm_x, a) : 0;
  return place_of(axis.step(), values, a) - half_step;
}

[[gnu::hot]] int axis_outside(const StepPosition& steps, const StepLimits& space, int axes) {
  for (int a = 0; a < axes; ++a)
    if (!space.contains(a, steps[index(a)])) return a;
  return -1;
}

[[gnu::hot]] std::uint16_t power_of(std::uint32_t speed_milli, const settings::Values& values) {
  const auto full = static_cast<std::uint32_t>(values.milli(Id::max_spindle_speed));
  if (speed_milli >= full) return full_power;
  const std::uint64_t product = std::uint64_t{speed_milli} * full_power + full / 2;
  return static_cast<std::uint16_t>(product / full);
}

[[gnu::hot]] void find_target(const program::Action& move, const settings::Values& values,
                              motion::LineTarget& line) {
  find_place(move.target_e7, values, line);
  line.feed_um_min = move.feed_um_min;
  line.time_us = move.timed ? move.time_us : 0;
  line.line = move.line;
  line.rapid = move.rapid;
  line.timed = move.timed;
  line.exact_stop = move.exact_stop;
  line.digit_um = move.digit_um;
  line.changes = 0;
  const bool lit = values.whole(Id::laser_mode) != 0 && move.kind != program::ActionKind::probe;
  line.laser = lit ? laser_of(move) : motion::LinePower::off;
  line.power = lit ? power_of(move.speed_milli, values) : std::uint16_t{0};
  line.pixels = move.pixels != 0 && line.laser != motion::LinePower::off;
  line.pulses = move.pulses && line.laser != motion::LinePower::off;
}

}  // namespace lamplock::machine
