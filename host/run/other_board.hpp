// Whether a profile, or a backup of settings, is for the board that it is sent to.
//
// In:  the pin map of the file ($990), the settings of the board. Out: an Error if they belong to
// different boards. Who: run_program(), `settings restore`.
#pragma once

#include <string>
#include <vector>

#include "host/link/board_settings.hpp"

namespace lamplock::run {

/// Throws Error(bad_input) if a file with this pin map is for another board than the one with these
/// settings; a board that does not report its pin map is not judged.
void refuse_file_of_other_board(const std::string& file, int pin_map,
                                const link::BoardSettings& board);

/// The same for the settings of a backup; one without a pin map is not judged.
void refuse_backup_of_other_board(const std::string& file, const std::vector<link::Change>& changes,
                                  const link::BoardSettings& board);

}  // namespace lamplock::run
