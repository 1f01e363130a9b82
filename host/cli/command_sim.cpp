// `lamplock sim`: a simulated board at the end of a real port, at the pace of the wall clock.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/board_options.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/interrupt.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/validators.hpp"
#include "host/run/simulate.hpp"

namespace lamplock::cli {
namespace {

struct SimOptions : run::SimOptions {
  bool json = false;
};

Exit simulate(const SimOptions& options) {
  Console console(options.json);
  const run::Simulated result = run::simulate(options, console);
  console.document(
      {{"shots", result.shots}, {"flashes", result.flashes}, {"not_written", result.lost.names()}});
  // Ctrl-C is the usual end of a simulation.
  const Exit end = is_ended_by_signal() ? Exit::interrupted : Exit::done;
  return result.lost.report(end, "the simulation was run", console);
}

}  // namespace

void add_sim(Command& program) {
  Command& app =
      program.add_command("sim", "Simulate a board in real time on a pseudo-terminal or TCP port");
  app.footer(
      "Example:\n  lamplock sim --pty /tmp/engraver --lamp 100\n"
      "  lamplock engrave model.stl --size 5 --board /tmp/engraver     # in another terminal");
  const auto options = std::make_shared<SimOptions>();
  app.add_option("--board", &options->board,
                 "virtual: simulation of the firmware core; chip: cycle-accurate simulation of the "
                 "flash image")
      .check(one_of({run::virtual_board, run::chip_board}))
      .value_name("virtual|chip")
      .show_default()
      .common();
  app.add_option("--image", &options->image,
                 "Flash image for the chip; default: the image of this build")
      .value_name("FILE")
      .file(FileUse::read);
  app.add_option("--pty", &options->pty,
                 "Open a pseudo-terminal and create a link of this name to it")
      .value_name("LINK")
      .file(FileUse::write)
      .common();
  app.add_option(
         "--tcp", &options->tcp,
         "Listen at this TCP address, one program connects at a time; port 0: any free port")
      .value_name("HOST:PORT")
      .common();
  app.add_option("--seconds", &options->seconds, "Stop after this time; default: run until Ctrl-C")
      .check(number_from(0, false))
      .value_name("S")
      .common();
  app.add_option("--vcd", &options->vcd, "Write a trace of all pins (VCD, for GTKWave)")
      .value_name("FILE")
      .file(FileUse::write, ".vcd")
      .common();
  app.add_option("--shots", &options->shots, "Write the laser shots (CSV)")
      .value_name("FILE")
      .file(FileUse::write, ".csv")
      .common();
  app.add_json(options->json);
  add_machine(app, options->machine);
  add_machine_overrides(app, options->machine);
  add_lamp_faults(app, options->faults);
  add_drives(app, options->drives);
  add_spot(app, options->spot);
  app.action([options] { return simulate(*options); });
}

}  // namespace lamplock::cli
