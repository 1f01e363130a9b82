#include "host/run/board_settings.hpp"

#include <filesystem>

#include "host/error.hpp"
#include "host/file/staged_file.hpp"
#include "host/run/settings_file.hpp"

namespace lamplock::run {

using link::Change;

SettingsSession::SettingsSession(const BoardOptions& options, const MachineOptions& machine)
    : link_(options, machine.profile().settings) {
  link::greet(link_.port());
  settings_ = link::read_settings(link_.port());
}

std::vector<Change> SettingsSession::bring_to(const std::vector<Change>& wanted,
                                              link::BoardSettings& after) {
  std::vector<Change> changes = link::differing(settings_, wanted);
  after = link::change_settings(link_.port(), settings_, changes);
  return changes;
}

std::vector<Change> parse_changes(const std::vector<std::string>& texts) {
  std::vector<Change> wanted;
  for (const std::string& text : texts) {
    wanted.push_back(link::parse_change(text, text));
    for (std::size_t i = 0; i + 1 < wanted.size(); ++i)
      if (wanted[i].number == wanted.back().number)
        throw Error(Exit::bad_input, text, "the setting is given twice", "keep one of the two");
  }
  return wanted;
}

void write_backup(const link::BoardSettings& settings, const std::string& file) {
  write_whole(file, backup_text(settings, is_toml(file)));
}

}  // namespace lamplock::run
