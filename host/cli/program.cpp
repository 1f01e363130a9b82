#include "host/cli/program.hpp"

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/version_report.hpp"
#include "host/version.hpp"

namespace lamplock::cli {

std::unique_ptr<Command> make_empty_program() {
  auto program = std::make_unique<Command>(
      "lamplock", "Engraves points inside glass, in step with the laser's lamp.");
  program->version(std::string("lamplock ") + version());
  return program;
}

std::unique_ptr<Command> make_own_commands() {
  auto program = make_empty_program();
  program->footer(
      "Example:\n  lamplock example model.stl\n"
      "  lamplock engrave model.stl --size 40 --spacing 0.3 --report report\n\n"
      "Each command has its own help: lamplock engrave -h shows the common options, lamplock\n"
      "engrave --help all of them.");
  add_version_report(*program);
  add_example(*program);
  add_estimate(*program);
  add_engrave(*program);
  add_points(*program);
  add_order(*program);
  add_check(*program);
  add_diagnose(*program);
  add_job(*program);
  add_raster(*program);
  add_send(*program);
  add_settings(*program);
  add_devices(*program);
  add_flash(*program);
  add_console(*program);
  add_frame(*program);
  add_operate(*program);
  add_jog(*program);
  add_lines(*program);
  add_compare(*program);
  add_sim(*program);
  return program;
}

std::unique_ptr<Command> make_program() {
  auto program = make_own_commands();
  add_chip_command(*program).separate_program("lamplock-chip");
  add_bench_command(*program).separate_program("lamplock-bench");
  add_help(*program);
  return program;
}

Command& add_chip_command(Command& program) {
  return program.add_command("chip",
                             "Run any image for the RP2040 in the chip simulator, cycle by cycle");
}

Command& add_bench_command(Command& program) {
  return program.add_command("bench",
                             "Benchmark the planner: plan points from published measurements and "
                             "compare with the optimum");
}

}  // namespace lamplock::cli
