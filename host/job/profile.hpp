// The machine profile: which machine a job is made for.
//
// In:  a profile (read_profile.hpp), options of the command line.
// Out: values for the settings table, and which of them were stated: these, and the geometry the
//      points were rounded with, travel with the job as overrides that end with it.
// Who: the command line, job building, the virtual board.
#pragma once

#include <bitset>
#include <string>

#include "shared/settings_table.hpp"

namespace lamplock::job {

/// A machine as its user describes it.
struct Profile {
  std::string name = "default";
  settings::Values settings;
  /// Settings the user has stated; the others are the machine's own business.
  std::bitset<settings::setting_count> stated;
};

/// 3 axes, 200 steps/mm, 1 m/s, 4 m/s2, 100 x 100 x 100 mm around the origin, lamp 100 Hz: the
/// defaults of the settings table.
Profile default_profile();

/// Sets and states one setting, value in its unit. `where` names the source in the Error(bad_input)
/// thrown when the value is out of range.
void state_setting(Profile& profile, settings::Id id, double value, const std::string& where);

/// Overrides of the command line, every axis alike.
void set_lamp_hz(Profile& profile, double hz);
void set_acceleration(Profile& profile, double m_s2);
void set_speed(Profile& profile, double m_s);

}  // namespace lamplock::job
