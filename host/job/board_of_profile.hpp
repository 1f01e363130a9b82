// The board that a profile is for: refuses settings that this board does not have.
//
// In:  a profile that states its pin map ($990).
// Out: an error with the setting, the board and the remedy. Who: MachineOptions::profile().
#pragma once

#include <string>

#include "host/job/profile.hpp"

namespace lamplock::job {

/// Throws Error(bad_input) about `file` for a pin map that no board has, and for a stated setting
/// that the board of this map refuses. A profile without a pin map is for any board.
void require_board_has(const Profile& profile, const std::string& file);

}  // namespace lamplock::job
