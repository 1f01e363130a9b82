// The protection of the laser against settings that would damage it.
//
// In:  the values of a job or of the user.
// Out: the number of a setting that violates a limit of the laser; 0 if there is none.
// Who: the controller, before it applies settings (main loop).
#pragma once

#include <cstdint>

#include "shared/beat.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::lamp {

/// Use of the answers of the photosensors ($927).
enum class ShotCheck : std::uint8_t { ignore = 0, count = 1, repeat = 2 };

constexpr ShotCheck shot_check(const settings::Values& values) {
  return static_cast<ShotCheck>(values.whole(settings::Id::shot_check));
}

/// A shot must be judged before the next one is handed to the board: lengths of ticks are handed
/// out up to 930 us ahead, and a board reads its photosensors at least every 250 us.
inline constexpr std::int64_t judgement_lead_ns = 1'250'000;

/// Thousandths of a per cent by which a beat may be shorter than nominal.
constexpr std::int32_t beat_range_milli(const settings::Values& values) {
  switch (static_cast<settings::LampMode>(values.whole(settings::Id::lamp_mode))) {
    case settings::LampMode::slave:
      return values.milli(settings::Id::lock_range);
    case settings::LampMode::master:
      return values.milli(settings::Id::period_tolerance);
    default:
      return 0;
  }
}

/// The controller triggers the lamp.
constexpr bool is_master(const settings::Values& values) {
  return values.whole(settings::Id::lamp_mode) == static_cast<int>(settings::LampMode::master);
}

/// Thousandths of a per cent by which our triggers may be faster than nominal.
constexpr std::int64_t faster_milli_percent(const settings::Values& values) {
  return is_master(values) ? values.milli(settings::Id::period_tolerance) : 0;
}

/// A triggered lamp flashes at most at its permitted frequency ($934).
constexpr bool lamp_frequency_holds(const settings::Values& values) {
  using settings::Id;
  if (!is_master(values)) return true;
  constexpr std::int64_t whole = 100'000;  // per cent, in thousandths
  return values.milli(Id::lamp_frequency) * (whole + faster_milli_percent(values)) <=
         values.milli(Id::max_lamp_frequency) * whole;
}

/// The energy of a flash is within its limit ($935), and known where we trigger the lamp: otherwise
/// its mean power could not be limited.
constexpr bool lamp_energy_holds(const settings::Values& values) {
  using settings::Id;
  const std::int32_t energy = values.milli(Id::lamp_energy);
  return energy <= values.milli(Id::max_lamp_energy) && (energy != 0 || !is_master(values));
}

/// Mean power of the lamp is within its limit: Ep * f ("Mechatroniczne pozycjonowanie wiazki lasera
/// impulsowego...": Ep * f < 1000 W), at the highest frequency that we may trigger it with.
constexpr bool lamp_power_holds(const settings::Values& values) {
  using settings::Id;
  constexpr std::int64_t whole = 100'000;  // per cent, in thousandths
  const std::int64_t faster = whole + faster_milli_percent(values);
  const std::int64_t micro_w =
      std::int64_t{values.milli(Id::lamp_energy)} * values.milli(Id::lamp_frequency);
  return micro_w * faster <= std::int64_t{values.milli(Id::lamp_power)} * 1000 * whole;
}

/// Frequency, energy and mean power of the lamp are within their limits.
[[gnu::cold]] constexpr bool lamp_bears(const settings::Values& values) {
  return lamp_frequency_holds(values) && lamp_energy_holds(values) && lamp_power_holds(values);
}

/// The photosensor answers in time for the decision that depends on it.
constexpr bool sensor_time_holds(const settings::Values& values) {
  using settings::Id;
  const ShotCheck check = shot_check(values);
  if (check == ShotCheck::ignore) return true;
  const std::int64_t nominal_ns = std::int64_t{beat_ticks(values)} * tick_ns;
  const std::int64_t beat_ns = nominal_ns - nominal_ns * beat_range_milli(values) / 100'000;
  const std::int64_t answer_ns =
      std::int64_t{values.milli(Id::q_switch_delay)} + values.milli(Id::sensor_time);
  return answer_ns + (check == ShotCheck::repeat ? judgement_lead_ns : 0) < beat_ns;
}

/// Number of a setting that violates a protection; 0 if there is none.
constexpr std::uint16_t broken_protection(const settings::Values& values) {
  using settings::Id;
  if (!lamp_frequency_holds(values)) return settings::number(Id::lamp_frequency);
  if (!lamp_energy_holds(values)) return settings::number(Id::lamp_energy);
  if (!lamp_power_holds(values)) return settings::number(Id::lamp_energy);
  if (!sensor_time_holds(values)) return settings::number(Id::sensor_time);
  return 0;
}

}  // namespace lamplock::lamp
