// The lines of the computer while a job runs: e-stop and door in, interlock and status lamp out.
//
// In:  levels, the time, that work begins, goes on or ends. Out: what the machine has to do, and
//      why; the two outputs.
// Who: whatever runs something on a real board (host/cli/guarding.hpp), in every round of its loop.
//
// What is pressed or lost comes first: the interlock falls in the same call that sees it, before
// anybody talks to the board. It is on only between begin() and end(), while every input is well,
// and not again before go_on(): closing a door does not give the laser its power back. An e-stop
// and a line that is lost last until the guard is gone.
//
// All of this comes on top of wires (docs/lines.md): a program may hang, and then nobody looks.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "host/gpio/line_table.hpp"
#include "host/gpio/lines.hpp"
#include "host/gpio/safe_input.hpp"

namespace lamplock::gpio {

/// What the lines want of the machine.
enum class Verdict : std::uint8_t {
  clear,  ///< nothing
  door,   ///< no light, no motion until the door is closed and somebody goes on
  stop    ///< the end of the job: e-stop, or a line was lost
};

/// What a guard is for.
enum class Work : std::uint8_t {
  motion,  ///< nothing is to fire: the interlock stays off
  laser
};

/// Watches the lines of one job.
class Guard {
 public:
  using Time = std::chrono::microseconds;

  /// Asks for the lines, outputs off. Throws Error as Lines does; `lines` must outlive the guard.
  Guard(Lines& lines, const LineTable& table);
  /// Interlock off first, then the lamp, then all lines are released.
  ~Guard();
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

  /// Looks at every line and switches the outputs. `now`: any clock that does not go back.
  Verdict look(Time now);
  /// As of the last look.
  Verdict verdict() const { return verdict_; }
  /// Why it is not clear, for people: "door open (GPIO27)".
  const std::string& reason() const { return reason_; }

  /// Work begins: from the next look on inputs count, and the interlock goes on if all is well.
  void begin(Work work);
  /// Somebody has said that it may go on: behind a door the interlock comes back.
  void go_on();
  /// Work is over: outputs off.
  void end();

  /// Every input is well, so that work may begin; they have to be looked at for debounce() first.
  bool settled() const;
  /// Which input is not, for people: "e-stop pressed (GPIO17)"; empty if settled.
  std::string unsettled() const;
  /// How long inputs have to be quiet before they count as released.
  Time debounce() const { return debounce_; }

 private:
  void judge();
  void stop(const char* what, const std::string& place);
  void switch_outputs(Time now);

  Time debounce_, interlock_beat_;
  std::optional<SafeInput> estop_, door_;
  std::string interlock_place_, lamp_place_;
  std::unique_ptr<Output> interlock_, lamp_;
  bool working_ = false, fires_ = false;
  bool waits_ = false;  ///< behind a door, for go_on()
  Verdict verdict_ = Verdict::clear;
  std::string reason_{};
};

}  // namespace lamplock::gpio
