#include "host/link/not_ready.hpp"

#include <fmt/format.h>

#include <chrono>

#include "host/error.hpp"
#include "host/link/board_settings.hpp"
#include "host/link/line_port.hpp"
#include "host/shell_text.hpp"

namespace lamplock::link {
namespace {

/// A board that does not answer must not delay the error for long.
constexpr Patience settings_patience{std::chrono::milliseconds(300),
                                     std::chrono::milliseconds(1000)};
/// Numbers after "Door" in a report.
constexpr int door_is_open = 1;
/// Alarm number of a machine that has not homed since power-up: 11, as in grblHAL.
constexpr int alarm_homing_wanted = 11;

NotReady door_open(const std::string& board) {
  return {"its door is open",
          "close the door; if the machine still waits, " + way_to_resume(board)};
}

NotReady estop_pressed(const std::string& board) {
  return {"its e-stop is pressed", "release it, then " + way_to_unlock(board, Homing::unknown)};
}

}  // namespace

std::string board_option(const std::string& board) {
  return board.empty() ? "" : " --board " + shell_text({board});
}

Homing homing_of(const BoardSettings& board) {
  if (!board.has(settings::Id::homing)) return Homing::unknown;
  return board.values.whole(settings::Id::homing) != 0 ? Homing::on : Homing::off;
}

Homing ask_homing(LinePort& port) {
  try {
    return homing_of(read_settings(port, settings_patience));
  } catch (const Error&) {  // it moves, or is gone
    return Homing::unknown;
  }
}

std::string way_to_unlock(const std::string& board, Homing homing) {
  const std::string home = "home it with lamplock operate home" + board_option(board),
                    unlock = "unlock it with $X in lamplock console" + board_option(board);
  switch (homing) {
    case Homing::on:
      return home + ", or " + unlock;
    case Homing::off:
      return unlock;
    case Homing::unknown:
      return unlock + ", or, if homing is on ($22=1), " + home;
  }
  return unlock;
}

std::string way_to_resume(const std::string& board) {
  return fmt::format(
      "resume it with ~ in lamplock console{}, or end there with :reset what it holds",
      board_option(board));
}

NotReady why_held(const std::string& board) { return {"is held (!)", way_to_resume(board)}; }

NotReady why_locked(const wire::StatusSummary& status, const std::string& board) {
  if (status.state == wire::MachineState::estop) return estop_pressed(board);
  if (status.alarm == 0 || status.alarm == alarm_homing_wanted)
    return {"is locked since power-up, as homing is on ($22)", way_to_unlock(board, Homing::on)};
  return {fmt::format("is locked ({})", alarm_text(status.alarm)),
          "find the cause, then " + way_to_unlock(board, Homing::unknown)};
}

NotReady why_stopped(const wire::StatusSummary& status, const std::string& board) {
  if (status.state == wire::MachineState::estop) return estop_pressed(board);
  if (status.state == wire::MachineState::door) return door_open(board);
  return {"its door is open or its e-stop is pressed",
          "close the door, release the e-stop, then repeat the command"};
}

NotReady why_not_ready(const BoardStatus& status, const std::string& board, Homing homing) {
  if (status.is("Alarm"))
    return {"is locked, since power-up or after an alarm",
            "find the cause of an alarm, then " + way_to_unlock(board, homing)};
  if (status.is("Hold")) return why_held(board);
  if (status.is("Door") && status.substate == door_is_open) return door_open(board);
  if (status.is("Door")) return {"waits since its door was open", way_to_resume(board)};
  if (status.is("Sleep"))
    return {"is asleep", fmt::format("wake it with :reset in lamplock console{}, then {}",
                                     board_option(board), way_to_unlock(board, homing))};
  return {fmt::format("is not idle ({})", status.state),
          fmt::format("wait until it is idle, or hold it with ! in lamplock console{}",
                      board_option(board))};
}

}  // namespace lamplock::link
