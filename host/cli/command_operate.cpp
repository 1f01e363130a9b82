// `lamplock operate`: what an operator does at the machine between jobs.
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/board_options.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/finish_job.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/validators.hpp"
#include "host/run/operate.hpp"
#include "shared/wire/records.hpp"

namespace lamplock::cli {
namespace {

using link::Operation;
using link::Places;

struct OperateOptions : run::OperateOptions {
  bool json = false;
};

constexpr unsigned max_flashes = std::numeric_limits<std::uint8_t>::max();

std::string place_text(const std::vector<double>& place) {
  std::string text;
  for (const double mm : place) text += fmt::format("{}{:.3f}", text.empty() ? "" : ", ", mm);
  return text;
}

/// Shows the places, for people and for programs.
Exit show(const Places& places, const std::string& done, Console& console) {
  console.say("{:<16} {}", "state", places.state);
  console.say("{:<16} {}", "position", place_text(places.machine));
  console.say("{:<16} {}", "zero", place_text(places.zero));
  console.say("{:<16} {}", "sample position", place_text(places.sample));
  console.say("{:<16} {}", "restore goes to", place_text(places.left));
  console.document({{"done", done},
                    {"state", places.state},
                    {"machine_mm", places.machine},
                    {"zero_mm", places.zero},
                    {"sample_mm", places.sample},
                    {"restore_mm", places.left}});
  return Exit::done;
}

Exit operate(const OperateOptions& options, Operation operation, const std::string& name) {
  Console console(options.json);
  return show(run::operate(options, operation, console), name, console);
}

Exit status(const OperateOptions& options) {
  Console console(options.json);
  return show(run::ask_places(options), "status", console);
}

Exit pulse(const OperateOptions& options) {
  Console console(options.json);
  run::JobOutcome outcome = run::fire_test_flashes(options, console);
  return finish_job(outcome, options.board, console);
}

/// Adds an operation, with the options of the board.
Command& add(Command& app, const std::shared_ptr<OperateOptions>& options, const char* name,
             const std::string& help, const Action& what) {
  Command& command = app.add_command(name, help);
  add_board_choice(command, options->board);
  add_machine(command, options->machine);
  command.add_json(options->json).group("Board");
  command.action([options, what] {
    options->board.profile = options->machine.machine;
    return what();
  });
  return command;
}

void add_operation(Command& app, const std::shared_ptr<OperateOptions>& options, const char* name,
                   const std::string& help, Operation operation) {
  add(app, options, name, help, [=] { return operate(*options, operation, name); });
}

void add_pulse(Command& app, const std::shared_ptr<OperateOptions>& options) {
  Command& command =
      add(app, options, "pulse",
          "Fire test flashes at the current position, one per beat, after confirmation",
          [options] { return pulse(*options); });
  command.add_option("--flashes", &options->flashes, "Number of flashes")
      .check(number_in({1u, max_flashes}))
      .value_name("N")
      .show_default();
  command.add_option("--channel", &options->channel, "Beam channel")
      .check(number_in({0u, unsigned{wire::max_channel}}))
      .value_name("N")
      .show_default();
  command.add_option("--energy", &options->energy, "Flash energy; 0: keep the current value")
      .check(number_in({0, std::numeric_limits<std::uint16_t>::max()}))
      .value_name("N")
      .show_default();
  command.add_option("--yes", &options->board.yes, "Do not ask before the first shot")
      .group("Board");
  command.add_option("--dry", &options->board.dry, "Run without firing").group("Board");
}

}  // namespace

void add_operate(Command& program) {
  Command& app =
      program.add_command("operate", "Store zero, move to stored positions, test the laser");
  app.footer(
      "The board keeps three positions without power: zero (G54), the sample position (G28) and\n"
      "the position for restore (G30). Ctrl-C holds the machine; during homing it resets the "
      "board.\n"
      "lamplock engrave --origin zero engraves at the stored zero.\n"
      "Example:\n"
      "  lamplock operate zero --axes XY --board /dev/ttyACM0\n"
      "  lamplock operate pulse --flashes 3 --board /dev/ttyACM0");
  const auto options = std::make_shared<OperateOptions>();
  add(app, options, "status", "Show the current position and the stored positions",
      [options] { return status(*options); });
  add_operation(app, options, "home", "Home the machine", Operation::home);
  Command& zero = add(app, options, "zero", "Store the current position as zero",
                      [options] { return operate(*options, Operation::zero, "zero"); });
  zero.add_option("--axes", &options->axes,
                  "Axes whose zero is stored, such as XY; default: all axes")
      .value_name("LETTERS");
  add_operation(app, options, "init", "Move to zero", Operation::init);
  Command& sample =
      add(app, options, "sample",
          "Move to the sample position, where the glass is loaded and unloaded", [options] {
            return operate(*options, options->teach ? Operation::teach_sample : Operation::sample,
                           "sample");
          });
  sample.add_option("--teach", &options->teach,
                    "Store the current position as the sample position");
  add_operation(app, options, "restore", "Move back to the position before the last init or sample",
                Operation::restore);
  add_pulse(app, options);
}

}  // namespace lamplock::cli
