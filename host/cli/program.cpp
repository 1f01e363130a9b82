#include "host/cli/program.hpp"

namespace lamplock::cli {

std::unique_ptr<CLI::App> make_program(Action& action) {
  auto program = std::make_unique<CLI::App>(
      "Engraves points inside glass, in step with the laser's lamp.", "lamplock");
  program->set_version_flag("--version", "lamplock " LAMPLOCK_VERSION);
  program->require_subcommand(1);
  program->footer(
      "Example:\n  lamplock example model.stl\n"
      "  lamplock engrave model.stl --size 40 --spacing 0.3 --report report\n\n"
      "Each command explains itself: lamplock engrave --help");
  add_example(*program, action);
  add_estimate(*program, action);
  add_engrave(*program, action);
  add_points(*program, action);
  add_order(*program, action);
  add_check(*program, action);
  add_diagnose(*program, action);
  add_job(*program, action);
  add_raster(*program, action);
  add_send(*program, action);
  add_settings(*program, action);
  add_devices(*program, action);
  add_flash(*program, action);
  add_console(*program, action);
  add_frame(*program, action);
  add_operate(*program, action);
  add_jog(*program, action);
  add_lines(*program, action);
  add_compare(*program, action);
  add_sim(*program, action);
  add_chip(*program, action);
  add_bench(*program, action);
  return program;
}

}  // namespace lamplock::cli
