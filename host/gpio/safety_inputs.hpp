// The computer's lines during a job: inputs e-stop and door, outputs interlock and status lamp.
//
// In:  levels, the time, begin, resume and end of work. Out: the required reaction of the machine
//      with its reason; the two outputs.
// Who: code that runs a job on a real board (host/run/supervisor.hpp), in every round of its loop.
//
// The interlock opens in the same call that detects a pressed, open or lost input, before the host
// sends to the board. It is on only between begin() and end(), while every input is well, and after
// a door only from resume(): closing a door does not restore the laser's power. An e-stop or a lost
// line lasts until the guard is destroyed.
//
// The guard does not replace wires (docs/lines.md): a program that hangs reads no input.
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

/// The reaction that the lines require.
enum class SafetyState : std::uint8_t {
  clear,  ///< none
  door,   ///< laser off and no motion until the door is closed and the user resumes
  stop    ///< end of the job: e-stop, or a lost line
};

/// Kind of work.
enum class LaserUse : std::uint8_t {
  motion,  ///< no shots: the interlock stays off
  laser
};

/// Watches the lines of one job.
class SafetyInputs {
 public:
  using Time = std::chrono::microseconds;

  /// Requests the lines, outputs off. Throws Error as Lines does; `lines` must outlive the guard.
  SafetyInputs(Lines& lines, const LineTable& table);
  /// Turns off the interlock, then the lamp, and releases all lines.
  ~SafetyInputs();
  SafetyInputs(const SafetyInputs&) = delete;
  SafetyInputs& operator=(const SafetyInputs&) = delete;

  /// Reads every line and switches the outputs. `now`: any monotonic clock.
  SafetyState poll(Time now);
  /// Result of the last poll().
  SafetyState state() const { return state_; }
  /// Why it is not clear, for the user: "door open (GPIO27)".
  const std::string& reason() const { return reason_; }

  /// Begins work: from the next poll() on inputs count, and the interlock is on if all are well.
  void begin(LaserUse work);
  /// Resumes work after an open door: the interlock may turn on again.
  void resume();
  /// Ends work: outputs off.
  void end();

  /// Every input is well, so that work may begin; call poll() for debounce() first.
  bool settled() const;
  /// The input that is not well, for the user: "e-stop pressed (GPIO17)"; empty if settled.
  std::string unsettled() const;
  /// Time without edges after which an input counts as released.
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
  bool waits_ = false;  ///< for resume(), after an open door
  SafetyState state_ = SafetyState::clear;
  std::string reason_{};
};

}  // namespace lamplock::gpio
