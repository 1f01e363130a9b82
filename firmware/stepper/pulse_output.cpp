#include "firmware/stepper/pulse_output.hpp"

namespace lamplock::stepper {
namespace {

using settings::Id;

/// Whole ticks that last at least this long, even the shortest ticks.
std::uint8_t ticks_of_ns(std::int32_t ns) {
  const auto least = static_cast<std::uint32_t>(ns);
  return static_cast<std::uint8_t>((least + min_tick_ns - 1) / min_tick_ns);
}
static_assert(settings::range(Id::direction_setup).max_milli / min_tick_ns < 255);
static_assert(settings::range(Id::direction_hold).max_milli / min_tick_ns < 255);
// Rounded up this is at least one tick.
static_assert(settings::range(Id::direction_setup).min_milli > 0);
static_assert(settings::range(Id::direction_hold).min_milli > 0);

}  // namespace

PulseOutput pulse_output(const settings::Values& values) {
  PulseOutput output;
  for (int a = 0; a < max_axes; ++a) {
    AxisPulses& axis = output.axis[index(a)];
    axis.mode = static_cast<PulseMode>(values.whole(Id::pulse_mode_x, a));
    axis.first_inverted = (values.whole(Id::step_invert) >> a & 1) != 0;
    axis.second_inverted = (values.whole(Id::direction_invert) >> a & 1) != 0;
  }
  output.pulses = pulse_times(values);
  const std::uint8_t high = output.pulses.high_ticks, period = output.pulses.period_ticks;
  const auto low = static_cast<std::uint8_t>(period - high);
  // Thousandths of a microsecond.
  const std::uint8_t setup = ticks_of_ns(values.milli(Id::direction_setup));
  const std::uint8_t hold = ticks_of_ns(values.milli(Id::direction_hold));
  output.times = {setup > low ? setup : low, hold > high ? hold : high, period};
  return output;
}

}  // namespace lamplock::stepper
