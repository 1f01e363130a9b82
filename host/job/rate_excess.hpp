// A max_rate that leaves no time for the step pulses, in words.
//
// In:  settings. Out: an error, or parts of one. Who: changes of settings, refusals of jobs,
//      simulated runs.
#pragma once

#include <optional>
#include <string>

#include "host/error.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::job {

struct RateExcessWords {
  settings::Id id;     ///< the max_rate
  std::string limit;   ///< "max_rate_x may be at most 29400 mm/min"
  std::string remedy;  ///< "lower it, or shorten step_pulse or step_low"
};

/// None if all rates leave time for the pulses (shared/pulse_times.hpp).
std::optional<RateExcessWords> rate_excess_words(const settings::Values& values);

/// The error for settings that make no motion possible; `setting`: the number of the one to blame.
Error no_motion(const settings::Values& values, std::uint16_t setting);

}  // namespace lamplock::job
