// The settings of a board: read, changed all or none, written to and read from files.
//
// In:  a board, changes or a file. Out: the settings, the changes that were made.
// Who: `settings`.
#pragma once

#include <string>
#include <vector>

#include "host/link/board_settings.hpp"
#include "host/run/board_link.hpp"
#include "host/run/board_options.hpp"
#include "host/run/machine_options.hpp"

namespace lamplock::run {

/// A board that has answered, and its settings.
class SettingsSession {
 public:
  /// Throws Error.
  SettingsSession(const BoardOptions& options, const MachineOptions& machine);
  const link::BoardSettings& settings() const { return settings_; }
  /// Changes the settings that differ from `wanted` and reads them back. Returns the changes; the
  /// new values are in `after`. Throws Error.
  std::vector<link::Change> bring_to(const std::vector<link::Change>& wanted,
                                     link::BoardSettings& after);

 private:
  BoardLink link_;
  link::BoardSettings settings_;
};

/// Changes as NAME=VALUE or NUMBER=VALUE, each setting once. Throws Error(bad_input).
std::vector<link::Change> parse_changes(const std::vector<std::string>& texts);

/// Writes all settings to a file, whole or not at all: TOML by its name, else lines. Throws Error.
void write_backup(const link::BoardSettings& settings, const std::string& file);

}  // namespace lamplock::run
