// The protection of the laser, as far as settings alone can break it.
//
// In:  the values a job or the user asks for.
// Out: the number of the setting that the laser does not bear; 0 if all is well.
// Who: the controller, before it takes settings over (main loop).
#pragma once

#include <cstdint>

#include "shared/beat.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::lamp {

/// What becomes of the answers of the photosensors ($927).
enum class ShotCheck : std::uint8_t { ignore = 0, count = 1, repeat = 2 };

constexpr ShotCheck shot_check(const settings::Values& values) {
  return static_cast<ShotCheck>(values.whole(settings::Id::shot_check));
}

/// A shot has to be judged before the next one is handed to the board: lengths of ticks are given
/// out up to 930 us ahead, and a board looks at its photosensors every 250 us at least.
inline constexpr std::int64_t judgement_lead_ns = 1'250'000;

/// By how many thousandths of a per cent a beat may be shorter than nominal.
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

/// Mean power of the lamp is within its limit: Ep * f ("Mechatroniczne pozycjonowanie wiazki lasera
/// impulsowego...": Ep * f < 1000 W), at the highest frequency that we may trigger it with.
constexpr bool lamp_power_holds(const settings::Values& values) {
  using settings::Id;
  constexpr std::int64_t whole = 100'000;  // per cent, in thousandths
  const bool master = values.whole(Id::lamp_mode) == static_cast<int>(settings::LampMode::master);
  const std::int64_t faster = whole + (master ? values.milli(Id::period_tolerance) : 0);
  const std::int64_t micro_w =
      std::int64_t{values.milli(Id::lamp_energy)} * values.milli(Id::lamp_frequency);
  return micro_w * faster <= std::int64_t{values.milli(Id::lamp_power)} * 1000 * whole;
}

/// The photosensor has answered in time for what its answer is to decide.
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

/// Number of a setting that breaks a protection; 0 if there is none.
constexpr std::uint16_t broken_protection(const settings::Values& values) {
  using settings::Id;
  if (!lamp_power_holds(values)) return settings::number(Id::lamp_energy);
  if (!sensor_time_holds(values)) return settings::number(Id::sensor_time);
  return 0;
}

}  // namespace lamplock::lamp
