#include "firmware/machine/inputs/temperature_loop.hpp"

#if LAMPLOCK_SENSOR_SETTINGS
namespace lamplock::machine {
namespace {

using settings::Id;

/// Steps that were missed are made up for only as long as they are few.
constexpr std::uint32_t max_late_periods = 4;

}  // namespace

void TemperatureLoop::restart() {
  scale_e11_ = one_e11;
  failed_ = false;
}

void TemperatureLoop::rest(const settings::Values& values) {
  scale_e11_ = one_e11;
  deviation_mk_ = deviation_mk(values);
}

void TemperatureLoop::watch(const settings::Values& values, std::uint32_t clock, bool runs) {
  const auto volts = static_cast<std::int32_t>(microvolts(level_));
  const bool good = volts >= values.milli(Id::sensor_min) && volts <= values.milli(Id::sensor_max);
  if (good) {
    good_clock_ = clock;
    if (runs) failed_ = false;
  } else if (clock - good_clock_ >= tolerated_clocks) {
    failed_ = true;
  }
}

bool TemperatureLoop::take_period(std::uint32_t clock) {
  const std::uint32_t passed = clock - step_clock_;
  if (passed < period_clocks) return false;
  step_clock_ = passed < max_late_periods * period_clocks ? step_clock_ + period_clocks : clock;
  return true;
}

/// Positive: the scale must fall.
[[gnu::cold]] std::int32_t TemperatureLoop::deviation_mk(const settings::Values& values) const {
  const std::int32_t above_uv =
      static_cast<std::int32_t>(microvolts(level_)) - values.milli(Id::loop_set_point);
  // uV times mK/V: nK. By 10^-6 = 4295 / 2^32, at most 2^57 before the shift.
  const std::int64_t nanokelvin = std::int64_t{above_uv} * values.milli(Id::sensor_scale);
  const auto mk = static_cast<std::int32_t>(nanokelvin * 4295 >> 32);
  const bool cools = mode(values) == settings::LoopMode::feed;
  return cools ? -mk : mk;
}

void TemperatureLoop::step(const settings::Values& values, bool lit) {
  const std::int32_t before_mk = deviation_mk_;
  deviation_mk_ = deviation_mk(values);
  if (!lit || failed_) return;
  constexpr std::int64_t milli_percent_e11 = one_e11 / 100'000;
  constexpr std::int64_t proportional_e11 = 1000;  // 10^-5 / K * 10^-3 K
  scale_e11_ -= std::int64_t{values.milli(Id::loop_ki)} * deviation_mk_;
  scale_e11_ -=
      proportional_e11 * values.milli(Id::loop_kp) * (std::int64_t{deviation_mk_} - before_mk);
  const std::int64_t low = milli_percent_e11 * values.milli(Id::loop_min);
  const std::int64_t high = milli_percent_e11 * values.milli(Id::loop_max);
  if (scale_e11_ < low) scale_e11_ = low;
  if (scale_e11_ > high) scale_e11_ = high;
}

std::uint32_t TemperatureLoop::scale_q15() const {
  // In units of 2^9 * 10^-11, which fit 32 bits up to 21; 720576 = 2^15 * 2^9 * 10^-11 * 2^32,
  // rounded up so that 1 is 1.
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(scale_e11_ >> 9) * 720'576 >> 32);
}

}  // namespace lamplock::machine
#endif
