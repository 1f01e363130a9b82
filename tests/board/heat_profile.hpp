// A machine with a continuous laser and a temperature sensor, for tests of the loop ($1061) on both
// boards.
#pragma once

#include <cmath>

#include "tests/board/rig.hpp"

namespace lamplock::test {

/// The spot: 300 K at 60 % power and 50 mm/s; 2 V there.
inline sim::HeatConfig heat_config() { return {}; }
inline constexpr double hot_k = 300, hot_power = 0.6, heat_kelvin_per_volt = 200;

/// Gains of lamplock heat --tune for a process of first order (docs/thermal.md, 8): overshoot 2.8
/// %, settled to 5 % within `settling_s` (0.05 s: 62.6 rad/s).
struct LoopGains {
  double kp_percent, ki_percent;  ///< %/K, %/(K s)
};
inline LoopGains loop_gains(const sim::HeatConfig& heat, double settling_s = 0.05) {
  const double zeta = 0.7512, omega = 62.6 * 0.05 / settling_s, tau = heat.time_constant_s;
  return {100 * (2 * zeta * omega * tau - 1) / hot_k, 100 * omega * omega * tau / hot_k};
}

/// No lamp, the map of a board with SENSOR; the loop is off.
inline job::Profile heat_profile(const LoopGains& gains = loop_gains(heat_config())) {
  job::Profile profile = program_profile();
  settings::Values& s = profile.settings;
  s.set_milli(Id::laser_mode, 1000);
  s.set_milli(Id::pin_map, static_cast<int>(boards::grblhal_pico.first_map) * 1000);
  s.set_milli(Id::loop_set_point, 2'000'000);
  s.set_milli(Id::loop_kp, static_cast<int>(std::lround(gains.kp_percent * 1000)));
  s.set_milli(Id::loop_ki, static_cast<int>(std::lround(gains.ki_percent * 1000)));
  s.set_milli(Id::sensor_scale, static_cast<int>(heat_kelvin_per_volt * 1000));
  s.set_milli(Id::sensor_min, 200'000);
  return profile;
}
inline job::Profile loop_profile(settings::LoopMode mode,
                                 const LoopGains& gains = loop_gains(heat_config())) {
  job::Profile profile = heat_profile(gains);
  profile.settings.set_milli(Id::loop, static_cast<int>(mode) * 1000);
  return profile;
}

/// The world with the spot.
inline sim::WorldConfig heated_world(const job::Profile& profile, const sim::HeatConfig& heat) {
  sim::WorldConfig world = world_for(profile);
  world.heat = heat;
  return world;
}

/// How a temperature returns after a disturbance at `at`, where it was constant.
struct HeatResponse {
  double first_k = 0;    ///< largest deviation, signed
  double settled_s = 0;  ///< from then on within 5 % of it
  double overshoot = 0;  ///< on the other side, as a part of it
  double final_k = 0;    ///< mean of the last 50 ms
};
inline HeatResponse response_of(const sim::HeatSensor& sensor, Picoseconds at, Picoseconds until) {
  HeatResponse response;
  const auto within = [&](Picoseconds from, Picoseconds to, const auto& use) {
    for (const auto& sample : sensor.samples())
      if (sample.at >= from && sample.at < to) use(sample);
  };
  const auto mean = [&](Picoseconds from, Picoseconds to) {
    double sum = 0, count = 0;
    within(from, to, [&](const auto& s) { sum += s.rise_k, ++count; });
    return sum / count;
  };
  const double wanted_k = mean(at - 50 * ps_per_ms, at);
  response.final_k = mean(until - 50 * ps_per_ms, until);
  double other = 0;
  within(at, until, [&](const auto& s) {
    const double off = s.rise_k - wanted_k;
    if (std::abs(off) > std::abs(response.first_k)) response.first_k = off;
  });
  within(at, until, [&](const auto& s) {
    const double off = s.rise_k - wanted_k;
    if (off * response.first_k < 0) other = std::max(other, std::abs(off));
    if (std::abs(off) > 0.05 * std::abs(response.first_k))
      response.settled_s = static_cast<double>(s.at - at) / static_cast<double>(ps_per_s);
  });
  response.overshoot = other / std::abs(response.first_k);
  return response;
}

}  // namespace lamplock::test
