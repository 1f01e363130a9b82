// Why a machine takes no job or no line now, and what its user does about it: one text for each
// state, with commands that end it.
//
// In:  the state as a frame or a report has it, the name of the board. Out: the two parts of an
//      error. Who: senders of jobs and programs, the operator's commands, the ends of runs.
#pragma once

#include <cstdint>
#include <string>

#include "host/link/board_text.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::link {

class LinePort;
struct BoardSettings;

/// Whether the machine can be homed ($22). Only a board knows it: a job may be for another value.
enum class Homing : std::uint8_t { unknown, off, on };
Homing homing_of(const BoardSettings& board);
/// Asks the board; unknown if it does not report its settings now.
Homing ask_homing(LinePort& port);

struct NotReady {
  std::string what, remedy;
};

/// " --board NAME" for the commands of a remedy; empty for a simulated board, which has no name.
std::string board_option(const std::string& board);

/// "home it with lamplock operate home --board NAME, or unlock it with $X in lamplock console ...";
/// homing is named only where it is on.
std::string way_to_unlock(const std::string& board, Homing homing);
/// How to end a hold.
std::string way_to_resume(const std::string& board);

/// A machine that is neither idle nor in check mode, by its report, which has no alarm number.
NotReady why_not_ready(const BoardStatus& status, const std::string& board, Homing homing);
/// A machine that has refused a job because it is locked, by its status: the alarm, or power-up.
NotReady why_locked(const wire::StatusSummary& status, const std::string& board);
/// One that has refused a job because its door is open or its e-stop is pressed.
NotReady why_stopped(const wire::StatusSummary& status, const std::string& board);
/// One that is held at rest.
NotReady why_held(const std::string& board);

}  // namespace lamplock::link
