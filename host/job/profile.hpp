// The machine profile: which machine a job is made for.
//
// In:  a TOML file (examples/machine.toml), options of the command line.
// Out: values for the settings table, and which of them were stated: these, and the geometry the
//      points were rounded with, travel with the job as overrides that end with it.
// Who: the command line, job building, the virtual board.
#pragma once

#include <bitset>
#include <filesystem>
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

/// Reads a profile; what it does not state stays at its default. Keys: `name`, the names of the
/// settings table, and arrays over the axes without the axis suffix (`travel = [100, 100, 60]`).
/// The tables `pendant` and `lines` belong to others (host/pendant/key_map.hpp,
/// host/gpio/line_table.hpp); the first is passed over, the second checked. Throws Error(bad_input)
/// with file, line, key and range.
Profile read_profile(const std::filesystem::path& file);

/// Sets and states one setting, value in its unit. `where` names the source in the Error(bad_input)
/// thrown when the value is out of range.
void state_setting(Profile& profile, settings::Id id, double value, const std::string& where);

/// Overrides of the command line, every axis alike.
void set_lamp_hz(Profile& profile, double hz);
void set_acceleration(Profile& profile, double m_s2);
void set_speed(Profile& profile, double m_s);

}  // namespace lamplock::job
