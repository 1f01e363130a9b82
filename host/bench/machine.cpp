#include "host/bench/machine.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace lamplock::bench {

settings::Values machine_settings(double lamp_hz, double accel_m_s2, double speed_m_s, int axes,
                                  double steps_per_mm) {
  using settings::for_axis;
  using settings::Id;
  settings::Values values;
  const auto milli = [](double v) { return static_cast<std::int32_t>(std::lround(v * 1000)); };
  values.set_milli(Id::lamp_frequency, milli(lamp_hz));
  values.set_milli(Id::axes, axes * 1000);
  for (int a = 0; a < max_axes; ++a) {
    values.set_milli(for_axis(Id::steps_per_mm_x, a), milli(steps_per_mm));
    values.set_milli(for_axis(Id::acceleration_x, a), milli(accel_m_s2 * 1e3));
    values.set_milli(for_axis(Id::max_rate_x, a), milli(speed_m_s * 6e4));
    values.set_milli(for_axis(Id::travel_x, a), 2'000'000);
    values.set_milli(for_axis(Id::min_corner_x, a), -1'000'000);
  }
  return values;
}

motion::Limits limits_of(const settings::Values& values, std::uint32_t tick_q16) {
  motion::Limits limits;
  std::uint16_t setting = 0;
  if (motion::make_limits(values, beat_ticks(values), tick_q16, limits, setting) != Result::ok)
    throw std::runtime_error("setting " + std::to_string(setting) + " refused");
  return limits;
}

}  // namespace lamplock::bench
