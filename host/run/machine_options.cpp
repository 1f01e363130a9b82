#include "host/run/machine_options.hpp"

#include <array>

#include "host/error.hpp"
#include "host/estimate/settings_check.hpp"
#include "host/gpio/read_line_table.hpp"
#include "host/job/board_of_profile.hpp"
#include "host/job/read_profile.hpp"

namespace lamplock::run {
namespace {

using settings::Id;
using settings::LampMode;

struct NamedLampMode {
  const char* name;
  LampMode mode;
};
constexpr std::array lamp_modes{NamedLampMode{"none", LampMode::free_beat},
                                NamedLampMode{"slave", LampMode::slave},
                                NamedLampMode{"master", LampMode::master}};

LampMode lamp_mode_named(const std::string& name) {
  for (const NamedLampMode& known : lamp_modes)
    if (name == known.name) return known.mode;
  throw Error(Exit::bad_input, "--lamp-mode", "unknown mode " + name, "use none, slave or master");
}

}  // namespace

job::Profile MachineOptions::profile() const {
  job::Profile profile = machine.empty() ? job::default_profile() : job::read_profile(machine);
  if (!machine.empty()) gpio::read_machine_lines(machine);  // refuses a wrong table [lines]
  if (lamp_hz) job::set_lamp_hz(profile, *lamp_hz);
  if (accel_m_s2) job::set_acceleration(profile, *accel_m_s2);
  if (speed_m_s) job::set_speed(profile, *speed_m_s);
  if (lamp_mode)
    job::state_setting(profile, Id::lamp_mode, static_cast<double>(lamp_mode_named(*lamp_mode)),
                       "--lamp-mode");
  if (!machine.empty()) job::require_board_has(profile, machine);
  estimate::check_settings(profile.settings);
  return profile;
}

job::Profile profile_of(const glass::MachineChoice& machine) {
  const MachineOptions options{machine.profile, machine.lamp_hz, machine.accel_m_s2,
                               machine.speed_m_s, machine.lamp_mode};
  return options.profile();
}

}  // namespace lamplock::run
