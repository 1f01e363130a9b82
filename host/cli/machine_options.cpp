#include "host/cli/machine_options.hpp"

#include "host/cli/validators.hpp"

namespace lamplock::cli {
namespace {

constexpr const char* machine_group = "Machine";

}  // namespace

void add_machine(Command& app, run::MachineOptions& options) {
  app.add_option("--machine", &options.machine,
                 "Machine profile (TOML); default: built-in settings")
      .value_name("FILE")
      .group(machine_group)
      .common();
}

void add_machine_overrides(Command& app, run::MachineOptions& options) {
  app.add_option("--lamp", &options.lamp_hz, "Lamp frequency")
      .value_name("HZ")
      .group(machine_group);
  app.add_option("--lamp-mode", &options.lamp_mode,
                 "slave: follow a free-running lamp; master: trigger the lamp; none: the board "
                 "generates the beat itself, without a lamp")
      .check(one_of({"slave", "master", "none"}))
      .value_name("slave|master|none")
      .group(machine_group);
  app.add_option("--accel", &options.accel_m_s2, "Maximum acceleration of every axis")
      .value_name("M_S2")
      .group(machine_group);
  app.add_option("--speed", &options.speed_m_s, "Maximum speed of every axis")
      .value_name("M_S")
      .group(machine_group);
}

}  // namespace lamplock::cli
