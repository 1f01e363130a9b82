// Whether a profile is for the board that a program is sent to.
//
// In:  the settings of a profile ($990 of them), those of the board. Out: an Error if they belong
// to different boards. Who: run_program().
#pragma once

#include <string>

#include "host/link/board_settings.hpp"

namespace lamplock::run {

/// Throws Error(bad_input) if the profile in this file is for another board than the one with these
/// settings; a board that does not report its pin map is not judged.
void refuse_profile_of_other_board(const std::string& file, const settings::Values& profile,
                                   const link::BoardSettings& board);

}  // namespace lamplock::run
