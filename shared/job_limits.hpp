// Limits of the settings that a job of points brings.
//
// In:  values of the job, values of the machine. Out: whether the machine permits them.
// Who: the firmware at the begin of a job (Controller::job_settings), in the main loop.
//
// Limits of one setting are the columns `scope` and `rule` of the table of settings; oversteps()
// applies the rule. The other functions are limits that depend on several settings. [[gnu::cold]]:
// the flash image keeps them in flash (toolchain/arm/rp2040.ld).
#pragma once

#include <cstdint>

#include "shared/settings_table.hpp"
#include "shared/wire/job_header.hpp"

namespace lamplock::settings {

/// True if a job needs another machine or more than the machine's own setting allows: its value
/// breaks the rule of the setting. Values in thousandths.
[[gnu::cold]] constexpr bool oversteps(Id id, std::int32_t asked, std::int32_t own) {
  switch (range(id).rule) {
    case Rule::any:
      break;
    case Rule::equal:
      return asked != own;
    case Rule::not_less:
      return asked < own;
    case Rule::not_more:
      return asked > own;
    case Rule::not_more_zero_unlimited:
      return own != 0 && (asked == 0 || asked > own);
    case Rule::subset:
      return ((asked / 1000) & ~(own / 1000)) != 0;
  }
  return false;
}

/// True if the work space of a job is inside the machine's own in this axis.
[[gnu::cold]] constexpr bool inside_work_space(const Values& job, const Values& own, int axis) {
  const auto low = [axis](const Values& v) { return v.milli(Id::min_corner_x, axis); };
  const auto high = [&](const Values& v) { return low(v) + v.milli(Id::travel_x, axis); };
  return low(job) >= low(own) && high(job) <= high(own);
}

/// Number of the setting by which a job would use the lamp in a way that the machine does not; 0 =
/// none. Free beats pulse LAMP TRIGGER too: on a machine with a lamp a job may use them only to
/// move, at most at the permitted frequency of the lamp.
[[gnu::cold]] constexpr std::uint16_t misused_lamp(const wire::JobHeader& header, const Values& job,
                                                   const Values& own) {
  const auto mode = [](const Values& v) { return static_cast<LampMode>(v.whole(Id::lamp_mode)); };
  if (mode(job) == LampMode::slave || mode(own) == LampMode::free_beat) {
    const bool allowed = mode(job) == LampMode::slave || mode(job) == mode(own);
    return allowed ? 0 : number(Id::lamp_mode);
  }
  const bool moves_only = mode(job) == LampMode::free_beat && header.dry;
  if (mode(job) != mode(own) && !moves_only) return number(Id::lamp_mode);
  const bool too_fast = job.milli(Id::lamp_frequency) > own.milli(Id::max_lamp_frequency);
  return too_fast ? number(Id::lamp_frequency) : 0;
}

}  // namespace lamplock::settings
