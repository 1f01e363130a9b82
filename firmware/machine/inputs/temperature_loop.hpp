// The loop that holds a temperature: scales the power of a continuous laser, or the feed rate.
//
// In:  the voltage of a sensor, the settings ($1061 to $1069), whether there is light.
// Out: a scale around 1, inside its limits at every step; whether the sensor has failed.
// Who: measure(): the board, main loop, before prepare(). The rest: prepare(), masked, while the
//      loop is on; watch() some 2 us in each round, step() some 10 us every millisecond.
//
// I-P controller (docs/thermal.md, 8): the set point acts through the integral alone,
//
//   u(n) = u(n - 1) - Ki T d(n) - Kp (d(n) - d(n - 1)),   d = temperature - set point,   T = 1 ms
//
// in the velocity form, whose only integral is the output itself. So the limits of the output are
// also those of the integral: it cannot wind up, and leaves a limit with the first step that points
// away from it. Where the laser is off the output stays: a step without light counts for nothing.
// A faster feed cools: for it the sign of d is the opposite.
//
// Units: temperatures in mK (int32: 3.3 V of 10 000 K/V), scales in 10^-11 (int64). With gains in
// thousandths of %/K and %/(K s) all products are exact integers: 10^-5 * 10^-3 K, times T.
//
// In images of boards without SENSOR it has no state and does nothing.
#pragma once

#include <cstdint>

#include "firmware/stepper/tick_block.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::machine {

#if LAMPLOCK_SENSOR_SETTINGS
class TemperatureLoop {
 public:
  static constexpr bool exists = true;
  static constexpr std::uint32_t period_clocks = 1000 * clocks_per_us;
  /// A sensor out of its range for this long has failed: a shorter disturbance is no reason to stop
  /// in the middle of a cut.
  static constexpr std::uint32_t tolerated_clocks = 1000 * clocks_per_us;
  static constexpr std::int64_t one_e11 = 100'000'000'000;

  static settings::LoopMode mode(const settings::Values& values) {
    return static_cast<settings::LoopMode>(values.whole(settings::Id::loop));
  }
  /// 65536 = 3.3 V.
  void measure(std::uint16_t level) { level_ = level; }

  /// Each round. A failure remains until motion runs (`runs`) with a sensor that works, so that the
  /// light does not return while the machine brakes. `clock`: lower half.
  [[gnu::cold]] void watch(const settings::Values& values, std::uint32_t clock, bool runs);
  bool failed() const { return failed_; }

  /// True once every period.
  [[gnu::cold]] bool take_period(std::uint32_t clock);
  /// One period; `lit`: there is light.
  [[gnu::cold]] void step(const settings::Values& values, bool lit);
  /// Scale 1, no failure; at rest.
  [[gnu::cold]] void restart();
  /// Scale 1: no program runs.
  [[gnu::cold]] void rest(const settings::Values& values);

  std::int64_t scale_e11() const { return scale_e11_; }
  /// 2^15 = 1; at most 2.
  [[gnu::cold]] std::uint32_t scale_q15() const;
  /// 100 = 1.
  [[gnu::cold]] std::uint32_t percent() const { return (scale_q15() * 100 + 0x4000) >> 15; }

  /// Voltage in uV of a level.
  static constexpr std::uint32_t microvolts(std::uint16_t level) {
    return level * 51'562u >> 10;  // 3.3 V / 2^16
  }

 private:
  std::int32_t deviation_mk(const settings::Values& values) const;

  std::int64_t scale_e11_ = one_e11;
  std::int32_t deviation_mk_ = 0;  ///< at the last step
  std::uint32_t good_clock_ = 0;   ///< of the last round with the sensor in its range
  std::uint32_t step_clock_ = 0;
  std::uint16_t level_ = 0;
  bool failed_ = false;
};
#else
class TemperatureLoop {
 public:
  static constexpr bool exists = false;
  static constexpr settings::LoopMode mode(const settings::Values&) {
    return settings::LoopMode::off;
  }
  static void measure(std::uint16_t) {}
  static constexpr bool failed() { return false; }
  static void restart() {}
  static constexpr std::uint32_t percent() { return 100; }
};
#endif

}  // namespace lamplock::machine
