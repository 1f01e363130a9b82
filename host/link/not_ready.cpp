#include "host/link/not_ready.hpp"

#include <fmt/format.h>

#include "host/shell_text.hpp"

namespace lamplock::link {
namespace {

/// Numbers after "Door" in a report.
constexpr int door_is_open = 1;
/// Alarm number of a machine that has not homed since power-up: 11, as in grblHAL.
constexpr int alarm_homing_wanted = 11;

NotReady door_open(const std::string& board) {
  return {"its door is open",
          "close the door; if the machine still waits, " + way_to_resume(board)};
}

NotReady estop_pressed(const std::string& board) {
  return {"its e-stop is pressed", "release it, then " + way_to_unlock(board)};
}

}  // namespace

std::string board_option(const std::string& board) {
  return board.empty() ? "" : " --board " + shell_text({board});
}

std::string way_to_unlock(const std::string& board) {
  return fmt::format(
      "home it with lamplock operate home{0}, or unlock it with $X in lamplock "
      "console{0}",
      board_option(board));
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
    return {"is locked since power-up, as homing is on ($22)", way_to_unlock(board)};
  return {fmt::format("is locked ({})", alarm_text(status.alarm)),
          "find the cause, then " + way_to_unlock(board)};
}

NotReady why_stopped(const wire::StatusSummary& status, const std::string& board) {
  if (status.state == wire::MachineState::estop) return estop_pressed(board);
  if (status.state == wire::MachineState::door) return door_open(board);
  return {"its door is open or its e-stop is pressed",
          "close the door, release the e-stop, then repeat the command"};
}

NotReady why_not_ready(const BoardStatus& status, const std::string& board) {
  if (status.is("Alarm"))
    return {"is locked, since power-up or after an alarm",
            "find the cause of an alarm, then " + way_to_unlock(board)};
  if (status.is("Hold")) return why_held(board);
  if (status.is("Door") && status.substate == door_is_open) return door_open(board);
  if (status.is("Door")) return {"waits since its door was open", way_to_resume(board)};
  if (status.is("Sleep"))
    return {"is asleep", fmt::format("wake it with :reset in lamplock console{}, then {}",
                                     board_option(board), way_to_unlock(board))};
  return {fmt::format("is not idle ({})", status.state),
          fmt::format("wait until it is idle, or hold it with ! in lamplock console{}",
                      board_option(board))};
}

}  // namespace lamplock::link
