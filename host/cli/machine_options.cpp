#include "host/cli/machine_options.hpp"

#include <array>

#include "host/cli/command_line.hpp"
#include "host/cli/validators.hpp"
#include "host/error.hpp"
#include "host/job/read_profile.hpp"

namespace lamplock::cli {
namespace {

using settings::Id;
using settings::LampMode;

constexpr const char* machine_group = "Machine";

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

void MachineOptions::add_machine(Command& app) {
  app.add_option("--machine", &machine, "Machine profile (TOML); without it the default machine")
      .value_name("FILE")
      .group(machine_group);
}

void MachineOptions::add_overrides(Command& app) {
  app.add_option("--lamp", &lamp_hz, "Lamp frequency").value_name("HZ").group(machine_group);
  app.add_option("--lamp-mode", &lamp_mode,
                 "slave: the lamp runs freely, we follow; master: we trigger it; none: free beat")
      .check(one_of({"slave", "master", "none"}))
      .value_name("slave|master|none")
      .group(machine_group);
  app.add_option("--accel", &accel_m_s2, "Highest acceleration of every axis")
      .value_name("M_S2")
      .group(machine_group);
  app.add_option("--speed", &speed_m_s, "Highest speed of every axis")
      .value_name("M_S")
      .group(machine_group);
}

job::Profile MachineOptions::profile() const {
  job::Profile profile = machine.empty() ? job::default_profile() : job::read_profile(machine);
  if (lamp_hz) job::set_lamp_hz(profile, *lamp_hz);
  if (accel_m_s2) job::set_acceleration(profile, *accel_m_s2);
  if (speed_m_s) job::set_speed(profile, *speed_m_s);
  if (lamp_mode)
    job::state_setting(profile, Id::lamp_mode, static_cast<double>(lamp_mode_named(*lamp_mode)),
                       "--lamp-mode");
  return profile;
}

job::Profile profile_of(const glass::MachineChoice& machine) {
  const MachineOptions options{machine.profile, machine.lamp_hz, machine.accel_m_s2,
                               machine.speed_m_s, machine.lamp_mode};
  return options.profile();
}

}  // namespace lamplock::cli
