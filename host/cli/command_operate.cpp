// `lamplock operate`: what an operator does at the machine between jobs.
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/board_files.hpp"
#include "host/cli/board_link.hpp"
#include "host/cli/board_port.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/guarding.hpp"
#include "host/cli/interrupt.hpp"
#include "host/cli/options.hpp"
#include "host/cli/report_job.hpp"
#include "host/cli/run_job.hpp"
#include "host/link/board_settings.hpp"
#include "host/link/operator.hpp"
#include "shared/wire/records.hpp"

namespace lamplock::cli {
namespace {

using link::Operation;
using link::Places;

constexpr unsigned most_flashes = std::numeric_limits<std::uint8_t>::max();

struct OperateOptions {
  BoardOptions board;
  MachineOptions machine;
  std::string axes;
  bool teach = false;
  unsigned flashes = 1, channel = 0;
  std::uint32_t energy = 0;
};

std::string place_text(const std::vector<double>& place) {
  std::string text;
  for (const double mm : place) text += fmt::format("{}{:.3f}", text.empty() ? "" : ", ", mm);
  return text;
}

/// Where everything is, for people and for programs.
void tell(const Places& places, const std::string& done, Console& console) {
  console.say("{:<16} {}", "stands at", place_text(places.machine));
  console.say("{:<16} {}", "zero", place_text(places.zero));
  console.say("{:<16} {}", "sample position", place_text(places.sample));
  console.say("{:<16} {}", "restore goes to", place_text(places.left));
  console.document({{"done", done},
                    {"machine_mm", places.machine},
                    {"zero_mm", places.zero},
                    {"sample_mm", places.sample},
                    {"restore_mm", places.left}});
}

Exit operate(const OperateOptions& options, Operation operation, const std::string& name) {
  Console console(options.board.json);
  BoardLink board(options.board, options.machine.profile().settings);
  link::require_ready(board.port(), operation);
  // A machine in alarm does not tell all of its places.
  const Places before = operation == Operation::home ? Places{} : link::ask_places(board.port());
  {
    const Interrupt interrupt;
    Guarding guarding(options.board, board.port().transport());
    guarding.begin(gpio::Work::motion);
    link::run_lines(board.port(), link::lines_of(operation, before, options.axes), [&] {
      guarding.look(board.port());
      return interrupt.count() > 0;
    });
  }
  tell(link::ask_places(board.port()), name, console);
  return Exit::done;
}

Exit status(const OperateOptions& options) {
  Console console(options.board.json);
  BoardLink board(options.board, options.machine.profile().settings);
  tell(link::ask_places(board.port()), "status", console);
  return Exit::done;
}

/// A job of one point: where the machine stands, by the machine's own settings.
Work pulse_work(link::LinePort& port, const OperateOptions& options) {
  link::require_ready(port, Operation::init);
  job::Profile profile;
  profile.settings = link::read_settings(port).values;
  const std::vector<double> at = link::ask_places(port).machine;
  const auto axis = [&at](std::size_t a) { return a < at.size() ? at[a] : 0; };
  job::JobOptions job;
  job.dry = options.board.dry;
  job.shots = static_cast<std::uint8_t>(options.flashes);
  job.channel = static_cast<std::uint8_t>(options.channel);
  job.energy = static_cast<std::uint16_t>(options.energy);
  Work work{"test pulse", {{axis(0), axis(1), axis(2)}}, {}};
  work.job = job::make_job(work.points, profile, job);
  // Points have three axes; a fourth one stays where it is.
  const PerAxis<double> scale = steps_per_mm(profile.settings);
  for (std::size_t a = 3; a < max_axes; ++a)
    work.job.targets.front().steps[a] = static_cast<std::int32_t>(std::lround(axis(a) * scale[a]));
  return work;
}

Exit pulse(const OperateOptions& options) {
  Console console(options.board.json);
  options.board.check();
  auto transport = open_port(options.board);
  Work work;
  if (transport) {
    link::LinePort port(*transport);
    work = pulse_work(port, options);
  } else {
    BoardLink board(options.board, options.machine.profile().settings);
    work = pulse_work(board.port(), options);
  }
  const Outcome outcome = run_job(work, options.board, std::move(transport), console);
  return report_job(outcome, options.board, console);
}

/// Adds an operation, with the options of the board.
Command& add(Command& app, const std::shared_ptr<OperateOptions>& options, const char* name,
             const std::string& help, const Action& what) {
  Command& command = app.add_command(name, help);
  options->board.add_choice(command);
  options->machine.add_machine(command);
  command.add_json(options->board.json).group("Board");
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
  Command& command = add(app, options, "pulse",
                         "Fire test flashes where the machine stands, beat by beat; asks first",
                         [options] { return pulse(*options); });
  command.add_option("--flashes", &options->flashes, "How many, 1 to 255")
      .check(number_in({1u, most_flashes}))
      .value_name("N")
      .show_default();
  command.add_option("--channel", &options->channel, "Beam channel")
      .check(number_in({0u, unsigned{wire::highest_channel}}))
      .value_name("0..3")
      .show_default();
  command.add_option("--energy", &options->energy, "Of the flash; 0: as the machine stands")
      .check(number_in({0, std::numeric_limits<std::uint16_t>::max()}))
      .value_name("N")
      .show_default();
  command.add_option("--yes", &options->board.yes, "Do not ask before the first shot")
      .group("Board");
  command.add_option("--dry", &options->board.dry, "Go through it, never fire").group("Board");
}

}  // namespace

void add_operate(Command& program) {
  Command& app = program.add_command(
      "operate", "Teach zero, go to it, to where the glass is changed and back, test the laser");
  app.footer(
      "The board keeps these places over power loss: zero is G54, the sample position G28, the\n"
      "place to come back to G30. Ctrl-C holds the machine; homing it resets. Engrave at the\n"
      "taught zero with lamplock engrave --origin zero.\n"
      "Example:\n  lamplock operate zero --axes XY --board /dev/ttyACM0\n"
      "  lamplock operate pulse --flashes 3 --board /dev/ttyACM0");
  const auto options = std::make_shared<OperateOptions>();
  add(app, options, "status", "Where the machine stands, and the places it keeps",
      [options] { return status(*options); });
  add_operation(app, options, "home", "Find the switches", Operation::home);
  Command& zero = add(app, options, "zero", "Teach: zero is where the machine stands",
                      [options] { return operate(*options, Operation::zero, "zero"); });
  zero.add_option("--axes", &options->axes, "Only of these axes, as in XY").value_name("LETTERS");
  add_operation(app, options, "init", "Go to zero", Operation::init);
  Command& sample = add(app, options, "sample", "Go where the glass is changed", [options] {
    return operate(*options, options->teach ? Operation::teach_sample : Operation::sample,
                   "sample");
  });
  sample.add_option("--teach", &options->teach, "Teach it: it is where the machine stands");
  add_operation(app, options, "restore", "Go back to where the machine stood before init or sample",
                Operation::restore);
  add_pulse(app, options);
}

}  // namespace lamplock::cli
