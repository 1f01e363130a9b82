#include "host/cli/machine_options.hpp"

#include <stdexcept>
#include <string>

#include "host/cli/validators.hpp"
#include "host/glass/description.hpp"

namespace lamplock::cli {
namespace {

constexpr const char* machine_group = "Machine";

/// The range of the option in a job description.
Check range_of_machine(const std::string& option) {
  glass::MachineChoice choice;
  for (const glass::Parameter& parameter : glass::parameters(choice))
    if (parameter.option == option) return number_in(parameter.range);
  throw std::logic_error("a description has no " + option);
}

}  // namespace

void add_machine(Command& app, run::MachineOptions& options) {
  app.add_option("--machine", &options.machine,
                 "Machine profile (TOML); default: built-in settings")
      .value_name("FILE")
      .file(FileUse::read)
      .group(machine_group)
      .common();
}

void add_machine_overrides(Command& app, run::MachineOptions& options) {
  app.add_option("--lamp", &options.lamp_hz, "Lamp frequency")
      .check(range_of_machine("--lamp"))
      .value_name("HZ")
      .group(machine_group)
      .common();
  app.add_option("--lamp-mode", &options.lamp_mode,
                 "slave: follow a free-running lamp; master: trigger the lamp; none: the board "
                 "generates the beat itself, without a lamp")
      .check(one_of({"slave", "master", "none"}))
      .value_name("slave|master|none")
      .group(machine_group);
  app.add_option("--accel", &options.accel_m_s2, "Maximum acceleration of each axis in m/s2")
      .check(range_of_machine("--accel"))
      .value_name("M_S2")
      .group(machine_group);
  app.add_option("--speed", &options.speed_m_s, "Maximum speed of each axis in m/s")
      .check(range_of_machine("--speed"))
      .value_name("M_S")
      .group(machine_group);
}

}  // namespace lamplock::cli
