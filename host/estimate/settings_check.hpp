// Whether any board would run a job with its settings.
//
// In:  the settings of a job. Out: nothing, or an Error that names the setting and what to change.
// Who: the use cases that make jobs, before they write or send one.
//
// The rules are those of the firmware (motion::make_limits(), lamp::broken_protection()), so that a
// job is not refused only at the machine. What a particular board does not allow is known to that
// board alone.
#pragma once

#include "shared/settings_table.hpp"

namespace lamplock::estimate {

/// Throws Error(bad_input) for settings that contradict each other.
void check_settings(const settings::Values& values);

}  // namespace lamplock::estimate
