// `lamplock settings`: what a board keeps, shown, changed, saved and brought back.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/board_link.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/options.hpp"
#include "host/cli/settings_file.hpp"
#include "host/cli/staged_file.hpp"
#include "host/file.hpp"
#include "host/link/board_settings.hpp"

namespace lamplock::cli {
namespace {

using link::BoardSettings;
using link::Change;
using settings::Id;

struct SettingsOptions {
  BoardOptions board;
  MachineOptions machine;
  std::string name, file;
  std::vector<std::string> changes;
};

/// A board that has answered, and what it keeps.
class Board {
 public:
  explicit Board(const SettingsOptions& options)
      : link_(options.board, options.machine.profile().settings) {
    link::greet(link_.port());
    settings_ = link::read_settings(link_.port());
  }
  const BoardSettings& settings() const { return settings_; }
  link::LinePort& port() { return link_.port(); }

 private:
  BoardLink link_;
  BoardSettings settings_;
};

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
  Console console(options.board.json);
  const Board board(options);
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

Exit get(const SettingsOptions& options) {
  Console console(options.board.json);
  const auto number = link::find_number(options.name);
  if (!number)
    throw Error(Exit::bad_input, options.name, "there is no such setting",
                "lamplock settings list shows their names and numbers");
  const Board board(options);
  const auto found = board.settings().texts.find(*number);
  if (found == board.settings().texts.end())
    throw Error(Exit::bad_input, link::setting_name(*number), "the board has no such setting",
                "lamplock settings list shows those that it has");
  if (console.json())
    console.document(as_json(*number, found->second, link::find_setting(*number)));
  else
    console.line(found->second);
  return Exit::done;
}

/// Makes what differs so; tells what it was and what it is.
Exit bring_to(const SettingsOptions& options, const std::vector<Change>& wanted) {
  Console console(options.board.json);
  Board board(options);
  const std::vector<Change> changes = link::differing(board.settings(), wanted);
  const BoardSettings after = link::change_settings(board.port(), board.settings(), changes);
  Json document = Json::array();
  for (const Change& change : changes) {
    const Id id = link::find_setting(change.number);
    const std::string &old = board.settings().texts.at(change.number),
                      &now = after.texts.at(change.number);
    console.say("{}: {} -> {}{}", link::setting_name(change.number), old, now,
                id == Id::count ? "" : fmt::format(" {}", settings::row(id).unit));
    document.push_back({{"number", change.number}, {"before", old}, {"after", now}});
  }
  if (changes.empty()) console.line("nothing differs");
  if (options.board.is_simulated() && !changes.empty())
    console.line("a simulated board forgets this now");
  console.document(document);
  return Exit::done;
}

Exit set(const SettingsOptions& options) {
  std::vector<Change> wanted;
  for (const std::string& text : options.changes) {
    wanted.push_back(link::parse_change(text, text));
    for (std::size_t i = 0; i + 1 < wanted.size(); ++i)
      if (wanted[i].number == wanted.back().number)
        throw Error(Exit::bad_input, text, "the setting is given twice", "give it once");
  }
  return bring_to(options, wanted);
}

Exit backup(const SettingsOptions& options) {
  Console console(options.board.json);
  check_target(options.file);
  const Board board(options);
  write_whole(options.file, [&](const std::filesystem::path& path) {
    write_file(path, backup_text(board.settings(), is_toml(options.file)));
  });
  console.say("{} settings in {}", board.settings().texts.size(), options.file);
  console.document({{"file", options.file}, {"settings", board.settings().texts.size()}});
  return Exit::done;
}

Exit restore(const SettingsOptions& options) {
  return bring_to(options, read_settings_file(options.file));
}

/// Adds one of the things to do, with the options of the board.
Command& add(Command& app, const std::shared_ptr<SettingsOptions>& options, const std::string& name,
             const std::string& what, const std::string& example,
             Exit (*run)(const SettingsOptions&)) {
  Command& sub = app.add_command(name, what);
  sub.footer("Example:\n  lamplock settings " + example);
  options->board.add_choice(sub);
  sub.add_json(options->board.json);
  options->machine.add_machine(sub);
  sub.action([options, run] { return run(*options); });
  return sub;
}

}  // namespace

void add_settings(Command& program) {
  Command& app =
      program.add_command("settings", "The settings of a board: list, get, set, backup, restore");
  app.footer(
      "Settings go by number or by name (docs/settings.md). A simulated board starts with those "
      "of\n"
      "--machine and forgets changes when the command ends.\n"
      "Example:\n  lamplock settings list --board /dev/ttyACM0\n"
      "  lamplock settings set acceleration_x=500 120=500 --board /dev/ttyACM0\n"
      "  lamplock settings backup board.toml --board /dev/ttyACM0");
  const auto options = std::make_shared<SettingsOptions>();
  add(app, options, "list", "All settings; a star where one is not the default",
      "list --board /dev/ttyACM0", list);
  add(app, options, "get", "One setting", "get lamp_frequency --board /dev/ttyACM0", get)
      .add_option("SETTING", &options->name, "Number or name")
      .required();
  add(app, options, "set", "Changes settings, all or none: checked, sent, read back",
      "set lamp_frequency=50 travel_x=300 --board /dev/ttyACM0", set)
      .add_option("CHANGE", &options->changes, "NAME=VALUE or NUMBER=VALUE")
      .required();
  add(app, options, "backup",
      "Writes all settings to a file: TOML (.toml), else lines of $NUMBER=VALUE",
      "backup board.toml --board /dev/ttyACM0", backup)
      .add_option("FILE", &options->file, "File to write")
      .required();
  add(app, options, "restore",
      "Brings settings back from a file; writes what differs, and says what that is",
      "restore board.toml --board /dev/ttyACM0", restore)
      .add_option("FILE", &options->file, "File of backup, or a machine profile")
      .required();
}

}  // namespace lamplock::cli
