// `lamplock settings`: what a board keeps, shown, changed, saved and brought back.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/cli/board_options.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/machine_options.hpp"
#include "host/file/staged_file.hpp"
#include "host/job/setting_range.hpp"
#include "host/run/board_settings.hpp"
#include "host/run/other_board.hpp"
#include "host/run/settings_file.hpp"

namespace lamplock::cli {
namespace {

using link::BoardSettings;
using link::Change;
using settings::Id;

struct SettingsOptions {
  bool json = false;
  run::BoardOptions board;
  run::MachineOptions machine;
  std::string file;
  std::vector<std::string> names, changes;
  bool values_only = false;
};

run::SettingsSession open(const SettingsOptions& options) {
  return {options.board, options.machine};
}

std::string default_text(Id id) { return link::value_text(id, settings::row(id).default_milli); }

Json as_json(std::uint32_t number, const std::string& text, Id id) {
  if (id == Id::count)
    return {{"number", number}, {"name", nullptr}, {"value", text}, {"known", false}};
  const settings::Row& row = settings::row(id);
  return {{"number", number},
          {"name", row.name},
          {"value", text},
          {"unit", row.unit},
          {"default", default_text(id)},
          {"known", true}};
}

/// One line of the list; a star where it is not the default.
void say_setting(Console& console, std::uint32_t number, const std::string& text, Id id) {
  if (id == Id::count)
    return console.say("{:>6}  {:<20} {:>12}  not known to this program",
                       fmt::format("${}", number), "-", text);
  const settings::Row& row = settings::row(id);
  console.say("{:>6}  {:<20} {:>12}{} {:<8} {:>12}  {}", fmt::format("${}", number), row.name, text,
              text == default_text(id) ? ' ' : '*', row.unit, default_text(id), row.description);
}

Exit list(const SettingsOptions& options) {
  Console console(options.json);
  const run::SettingsSession board = open(options);
  Json document = Json::array();
  if (!console.json())
    console.say("{:>6}  {:<20} {:>12}  {:<8} {:>12}", "number", "name", "value", "unit", "default");
  for (const auto& [number, text] : board.settings().texts) {
    if (!console.json()) say_setting(console, number, text, link::find_setting(number));
    document.push_back(as_json(number, text, link::find_setting(number)));
  }
  console.document(document);
  return Exit::done;
}

/// "$901 lamp_frequency: 100.000 Hz"
std::string value_line(std::uint32_t number, const std::string& text) {
  const Id id = link::find_setting(number);
  const std::string name = link::setting_name(number);
  if (id == Id::count) return fmt::format("{}: {} (not known to this program)", name, text);
  return fmt::format("{}: {}{}", name, text, job::unit_suffix(settings::row(id)));
}

/// All names are checked before the board is opened.
Exit get(const SettingsOptions& options) {
  Console console(options.json);
  std::vector<std::uint32_t> numbers;
  for (const std::string& name : options.names)
    numbers.push_back(link::number_of_setting(name, "lamplock settings get"));
  const run::SettingsSession board = open(options);
  const auto& texts = board.settings().texts;
  for (const std::uint32_t number : numbers)
    if (!texts.contains(number))
      throw Error(Exit::bad_input, link::setting_name(number), "the board has no such setting",
                  "lamplock settings list shows the settings of the board");
  Json document = Json::array();
  for (const std::uint32_t number : numbers) {
    const std::string& text = texts.at(number);
    if (!console.json()) console.line(options.values_only ? text : value_line(number, text));
    document.push_back(as_json(number, text, link::find_setting(number)));
  }
  console.document(numbers.size() == 1 ? document.front() : document);
  return Exit::done;
}

/// Changes the settings that differ, and lists them. A file may be of a board with more settings.
Exit bring_to(const SettingsOptions& options, std::vector<Change> wanted, bool is_file) {
  Console console(options.json);
  run::SettingsSession board = open(options);
  if (is_file) {
    run::refuse_backup_of_other_board(options.file, wanted, board.settings());
    wanted = link::without_missing_defaults(board.settings(), std::move(wanted));
  }
  BoardSettings after;
  const std::vector<Change> changes = board.bring_to(wanted, after);
  Json document = Json::array();
  for (const Change& change : changes) {
    const Id id = link::find_setting(change.number);
    const std::string &old = board.settings().texts.at(change.number),
                      &now = after.texts.at(change.number);
    console.say("{}: {} -> {}{}", link::setting_name(change.number), old, now,
                id == Id::count ? "" : job::unit_suffix(settings::row(id)));
    document.push_back({{"number", change.number}, {"before", old}, {"after", now}});
  }
  if (changes.empty()) console.line("nothing differs");
  if (options.board.is_simulated() && !changes.empty())
    console.line("simulated board: changes are not kept");
  console.document(document);
  return Exit::done;
}

Exit set(const SettingsOptions& options) {
  return bring_to(options, run::parse_changes(options.changes), false);
}

Exit backup(const SettingsOptions& options) {
  Console console(options.json);
  check_target(options.file);
  const run::SettingsSession board = open(options);
  run::write_backup(board.settings(), options.file);
  console.say("{} settings in {}", board.settings().texts.size(), options.file);
  console.document({{"file", options.file}, {"settings", board.settings().texts.size()}});
  return Exit::done;
}

Exit restore(const SettingsOptions& options) {
  return bring_to(options, run::read_settings_file(options.file), true);
}

/// What begins a change, for shells.
std::vector<std::string> names_with_equals() {
  std::vector<std::string> names = link::setting_names();
  for (std::string& name : names) name += '=';
  return names;
}

/// Adds one of the things to do, with the options of the board.
Command& add(Command& app, const std::shared_ptr<SettingsOptions>& options, const std::string& name,
             const std::string& what, const std::string& example,
             Exit (*run)(const SettingsOptions&)) {
  Command& sub = app.add_command(name, what);
  sub.footer("Example:\n  lamplock settings " + example);
  add_board_choice(sub, options->board);
  sub.add_json(options->json);
  add_machine(sub, options->machine);
  sub.action([options, run] { return run(*options); });
  return sub;
}

}  // namespace

void add_settings(Command& program) {
  Command& app = program.add_command(
      "settings", "List, show, change, back up or restore the settings of a board");
  app.footer(
      "A setting is named by its number or its name (docs/settings.md). A simulated board starts\n"
      "with the settings of --machine and forgets changes when the command ends.\n"
      "Example:\n"
      "  lamplock settings list --board /dev/ttyACM0\n"
      "  lamplock settings set acceleration_x=500 121=500 --board /dev/ttyACM0\n"
      "  lamplock settings backup board.toml --board /dev/ttyACM0");
  const auto options = std::make_shared<SettingsOptions>();
  add(app, options, "list", "List all settings; * marks a value that differs from its default",
      "list --board /dev/ttyACM0", list);
  Command& get_command = add(app, options, "get", "Show settings: number, name, value and unit",
                             "get lamp_frequency travel_x --board /dev/ttyACM0", get);
  get_command.add_option("SETTING", &options->names, "Number or name of a setting")
      .required()
      .completions(link::setting_names());
  get_command.add_option("--value", &options->values_only,
                         "Print the values alone, one on each line, for scripts");
  add(app, options, "set",
      "Change settings, all or none; the values are checked, sent and read back",
      "set lamp_frequency=50 travel_x=300 --board /dev/ttyACM0", set)
      .add_option("CHANGE", &options->changes, "NAME=VALUE or NUMBER=VALUE")
      .required()
      .completions(names_with_equals());
  add(app, options, "backup",
      "Write all settings to a file: TOML (.toml), otherwise lines $NUMBER=VALUE",
      "backup board.toml --board /dev/ttyACM0", backup)
      .add_option("FILE", &options->file, "File to write")
      .file(FileUse::write, ".toml")
      .required();
  add(app, options, "restore",
      "Restore settings from a file: write the settings that differ and list them",
      "restore board.toml --board /dev/ttyACM0", restore)
      .add_option("FILE", &options->file, "Backup file or machine profile")
      .file(FileUse::read)
      .required();
}

}  // namespace lamplock::cli
