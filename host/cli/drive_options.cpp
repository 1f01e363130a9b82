#include "host/cli/drive_options.hpp"

#include "host/cli/validators.hpp"

namespace lamplock::cli {
namespace {

/// Wider than any drive, and such that no figure of the simulation overflows.
constexpr glass::Range per_rev_range{1e-3, 1e9, true}, time_constant_range{1e-3, 1e5, true},
    damping_range{1e-2, 99, true};

}  // namespace

void add_servo_drives(Command& app, program_run::ServoMachine& machine,
                      const std::string& y_default) {
  const auto number = [&app](const char* name, double& value, const char* text, const char* unit,
                             const glass::Range& range) {
    app.add_option(name, &value, text)
        .check(number_in(range))
        .value_name(unit)
        .show_default()
        .group("Drives");
  };
  number("--pulses", machine.drive.steps_per_rev, "Step pulses per revolution", "N", per_rev_range);
  number("--mm-per-rev", machine.drive.mm_per_rev, "Travel per revolution", "MM", per_rev_range);
  number("--encoder", machine.drive.counts_per_rev, "Encoder counts per revolution", "N",
         per_rev_range);
  number("--time-constant", machine.drive.time_constant_ms, "Time constant of the position loop",
         "MS", time_constant_range);
  app.add_option("--time-constant-y", &machine.time_constant_y_ms,
                 "Time constant of Y; default: " + y_default)
      .check(number_in(time_constant_range))
      .value_name("MS")
      .group("Drives");
  number("--damping", machine.drive.damping, "Damping ratio of the position loop, for --order 2",
         "N", damping_range);
  app.add_option("--order", &machine.drive.order, "Order of the position loop")
      .check(number_in({1, 2}))
      .value_name("N")
      .show_default()
      .group("Drives");
}

}  // namespace lamplock::cli
