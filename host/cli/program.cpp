#include "host/cli/program.hpp"

#include <fmt/format.h>

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
      "  lamplock engrave model.stl --size 40 --spacing 0.3 --report report");
  add_version_report(*program);
  add_example(*program);
  add_estimate(*program);
  add_engrave(*program);
  add_points(*program);
  add_order(*program);
  add_check(*program);
  add_diagnose(*program);
  add_jerk(*program);
  add_heat(*program);
  add_job(*program);
  add_raster(*program);
  add_cut(*program);
  add_material(*program);
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

namespace {

/// Has a help of its own for a build without the program, which has the help with the options.
void make_separate(Command& command, const std::string& name) {
  command.separate_program(name);
  command.footer(fmt::format(
      "The program {0} runs this command and has the help with its options. This build of\n"
      "lamplock does not have it. The Debian package contains it; in the source tree build it:\n"
      "  cmake --build build --target {0}",
      name));
}

}  // namespace

std::unique_ptr<Command> make_program() {
  auto program = make_own_commands();
  make_separate(add_serve_command(*program), "lamplock-serve");
  make_separate(add_watch_command(*program), "lamplock-serve");
  make_separate(add_chip_command(*program), "lamplock-chip");
  make_separate(add_bench_command(*program), "lamplock-bench");
  add_help(*program);
  return program;
}

Command& add_serve_command(Command& program) {
  return program.add_command(
      "serve", "Operate a machine from a page in the browser, and from programs by JSON-RPC");
}

Command& add_watch_command(Command& program) {
  return program.add_command("watch", "Show the state and progress of a machine that serve holds");
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
