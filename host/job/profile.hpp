// The machine profile: describes the machine that a job is made for.
//
// In:  a profile (read_profile.hpp), options of the command line.
// Out: values for the settings table, and the set of those stated: these, and the geometry that the
//      points were rounded with, are part of the job as overrides that end with it.
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
  /// Settings that the user has stated; the machine keeps its own values of the others.
  std::bitset<settings::setting_count> stated;
};

/// 3 axes, 200 steps/mm, 1 m/s, 4 m/s2, 100 x 100 x 100 mm around the origin, lamp 100 Hz: the
/// defaults of the settings table.
Profile default_profile();

/// Sets and states one setting, value in its unit. `where` names the source in the Error(bad_input)
/// thrown when the value is out of range.
void state_setting(Profile& profile, settings::Id id, double value, const std::string& where);

/// Overrides of the command line, the same for every axis.
void set_lamp_hz(Profile& profile, double hz);
void set_acceleration(Profile& profile, double m_s2);
void set_speed(Profile& profile, double m_s);

}  // namespace lamplock::job
