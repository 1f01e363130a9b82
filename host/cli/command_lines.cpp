// `lamplock lines`: the lines of this computer, and the board's reset by them.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/gpio/board_lines.hpp"
#include "host/gpio/host_lines.hpp"
#include "host/gpio/line_address.hpp"
#include "host/gpio/line_table.hpp"
#include "host/gpio/read_line_table.hpp"

namespace lamplock::cli {
namespace {

struct LinesOptions {
  std::string file, profile;
  bool json = false;
};

/// One line of the table and what its pin says now.
struct Wired {
  const char* role;
  const std::optional<gpio::LineRequest>& line;
  const char *active, *inactive;  ///< what the levels mean; null for outputs, which are not asked
};

std::vector<Wired> wired_lines(const gpio::LineTable& table) {
  return {{"estop", table.estop, "pressed", "released"},
          {"door", table.door, "open", "closed"},
          {"interlock", table.interlock, nullptr, nullptr},
          {"lamp", table.lamp, nullptr, nullptr},
          {"run", table.run, nullptr, nullptr},
          {"bootsel", table.bootsel, nullptr, nullptr}};
}

gpio::LineTable table_of(const LinesOptions& options) {
  return options.file.empty() ? gpio::read_machine_lines(options.profile)
                              : gpio::read_line_table(options.file);
}

/// What an input says now; an output is there and free, and stays as it is. Throws Error.
std::string state_of(gpio::Lines& lines, const Wired& wired) {
  if (wired.active == nullptr) {
    gpio::check_free(lines.chips(), wired.line->place);
    return "output";
  }
  const std::optional<bool> active = lines.input(*wired.line)->active();
  return !active ? "lost" : *active ? wired.active : wired.inactive;
}

Json table_json(gpio::Lines& lines, const gpio::LineTable& table, Console& console) {
  Json all = Json::array();
  for (const Wired& wired : wired_lines(table)) {
    if (!wired.line) continue;
    const std::string state = state_of(lines, wired);
    console.say("{:<10} {:<20} {}", wired.role, wired.line->place, state);
    all.push_back({{"role", wired.role}, {"line", wired.line->place}, {"state", state}});
  }
  return all;
}

Json chip_json(const gpio::ChipInfo& chip, Console& console) {
  Json lines = Json::array();
  console.say("{}  {}", chip.file,
              chip.problem.empty() ? fmt::format("{}, {} lines", chip.label, chip.lines.size())
                                   : chip.problem);
  for (const gpio::LineInfo& line : chip.lines) {
    lines.push_back({{"number", line.number},
                     {"name", line.name},
                     {"user", line.user},
                     {"output", line.output}});
    if (!line.name.empty() || !line.user.empty())
      console.say("  {:>3}  {:<24} {}", line.number, line.name,
                  line.user.empty() ? "" : "used by " + line.user);
  }
  return {{"chip", chip.file},
          {"label", chip.label},
          {"problem", chip.problem},
          {"lines", std::move(lines)}};
}

[[noreturn]] void throw_no_line(const std::string& where) {
  throw Error(Exit::bad_input, where, "no GPIO line is assigned to the board's pins",
              "give --lines, or --machine with [lines]");
}

Exit show(const LinesOptions& options) {
  Console console(options.json);
  const std::unique_ptr<gpio::Lines> lines = gpio::host_lines();
  if (!options.file.empty() || !options.profile.empty()) {
    const Json table = table_json(*lines, table_of(options), console);
    if (table.empty() && options.file.empty()) throw_no_line(options.profile);
    console.document({{"library", gpio::library_version()}, {"table", table}});
    return Exit::done;
  }
  Json chips = Json::array();
  for (const gpio::ChipInfo& chip : lines->chips()) chips.push_back(chip_json(chip, console));
  if (chips.empty())
    console.say("this computer has no GPIO lines known to Linux ({})", gpio::library_version());
  console.document({{"library", gpio::library_version()}, {"chips", chips}});
  return Exit::done;
}

using Pull = void (*)(gpio::Lines&, const gpio::LineTable&, const gpio::Sleep&);

Exit pull(const LinesOptions& options, Pull what, const char* done) {
  Console console(false);
  const gpio::LineTable table = table_of(options);
  const std::unique_ptr<gpio::Lines> lines = gpio::host_lines();
  what(*lines, table, gpio::real_sleep);
  console.line(done);
  return Exit::done;
}

void add_file(Command& app, LinesOptions& options) {
  app.add_option("--lines", &options.file,
                 "File (TOML) that assigns functions to GPIO lines; see examples/lines.toml")
      .environment("LAMPLOCK_LINES")
      .value_name("FILE")
      .file(FileUse::read);
  app.add_option("--machine", &options.profile,
                 "Machine profile with a table [lines]; used without --lines")
      .value_name("FILE")
      .file(FileUse::read);
}

void add_pull(Command& app, const std::shared_ptr<LinesOptions>& options, const char* name,
              const std::string& help, Pull what, const char* done) {
  Command& command = app.add_command(name, help);
  add_file(command, *options);
  command.action([options, what, done, name = std::string(name)] {
    if (options->file.empty() && options->profile.empty()) throw_no_line("lamplock lines " + name);
    return pull(*options, what, done);
  });
}

}  // namespace

void add_lines(Command& program) {
  Command& app = program.add_command(
      "lines", "List the GPIO lines of this computer, show the wired inputs, reset the board");
  app.footer(
      "With --lines, the command shows the current state of the inputs in that file; it checks "
      "that\n"
      "the outputs exist but does not switch them.\n"
      "reset and loader act on the board's pins at once: make sure that no job runs.\n"
      "Example:\n"
      "  lamplock lines\n"
      "  lamplock lines --lines examples/lines.toml\n"
      "  lamplock lines reset --lines examples/lines.toml");
  const auto options = std::make_shared<LinesOptions>();
  add_file(app, *options);
  app.add_json(options->json);
  app.action([options] { return show(*options); });
  add_pull(app, options, "reset", "Reset the board by a pulse on its RUN pin", gpio::reset_board,
           "the board was reset");
  add_pull(app, options, "loader",
           "Reset the board into its boot loader: pulse RUN while BOOTSEL is low",
           gpio::enter_loader, "the board was reset into its boot loader");
}

}  // namespace lamplock::cli
