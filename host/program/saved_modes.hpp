// Lines that restore, at the end of a subroutine, the modes that were in force at its M73
// (LinuxCNC, "M Codes", M73).
//
// In:  the modal state of then and of now. Out: lines of words that bring the first one back.
// Who: program_flow.cpp. The board itself keeps one saved state (M70), calls may be nested.
#pragma once

#include <string>
#include <vector>

#include "firmware/program/modal.hpp"

namespace lamplock::program_run {

/// The modes that lines_to_restore() cannot bring back if they have changed: the rotation, the beat
/// lock, pulses. Their codes; empty if all can be.
std::string lost_modes(const program::Modal& saved, const program::Modal& now);

/// Restores units, distances, plane, coordinate system, path mode, feed mode and F, retract level,
/// S, spindle, coolant and overrides. The motion and the tool stay, as after M72.
std::vector<std::string> lines_to_restore(const program::Modal& saved, const program::Modal& now);

}  // namespace lamplock::program_run
