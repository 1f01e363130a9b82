// Supervises a real board by the lines of this computer: e-stop, door, interlock.
//
// In:  the line table of --lines, polls from the loop of a use case. Out: a board that is held or
//      stopped through the firmware; the error that names the line.
// Who: run_job, run_program, `operate`, `console`, `jog`: once in every round of their loops, after
//      the poll of the user's control, so that a line has the last word.
//
// A job is held or stopped by its frames: COMMAND stop for an e-stop; an open door holds a job of
// points and stops a job of rows, whose laser would be on while it brakes for a hold. Programs and
// single lines get a byte: 0x18 for an e-stop, after which the laser is off before the machine
// brakes, 0x84 for a door, which switches the laser off and keeps the position.
#pragma once

#include <memory>
#include <string>

#include "host/gpio/lines.hpp"
#include "host/gpio/safety_inputs.hpp"
#include "host/link/line_port.hpp"
#include "host/link/line_sender.hpp"
#include "host/link/transport.hpp"
#include "host/run/board_options.hpp"
#include "host/run/job_control.hpp"

namespace lamplock::run {

/// What an open door does to a job.
enum class AtDoor : std::uint8_t { holds, ends };

/// Supervises one job, program or session; without lines, and on simulated boards, it does nothing.
class Supervisor {
 public:
  /// Requests the lines; the clock is that of the transport, which must outlive this. Throws Error.
  Supervisor(const BoardOptions& options, link::Transport& transport);
  /// Supervises with these lines.
  Supervisor(std::unique_ptr<gpio::Lines> lines, const gpio::LineTable& table,
             link::Transport& transport);

  /// Waits until the inputs are quiet. Throws Error(job_failed) if one of them forbids to begin.
  void begin(gpio::LaserUse work);
  /// Switches the outputs off and ends the supervision.
  void end();

  /// To be called after every poll of the control, which it holds or ends.
  void poll(JobControl& control, AtDoor at_door);
  /// Single lines: an open door or a pressed e-stop stops the machine and is thrown as
  /// Error(job_failed).
  void poll(link::LinePort& port);

  /// Why it ended the job: "e-stop pressed (GPIO17)"; empty if it did not.
  const std::string& ended_by() const { return ended_by_; }

 private:
  gpio::SafetyState read_lines();
  void resume_after_door();

  link::Transport& transport_;
  std::unique_ptr<gpio::Lines> lines_{};
  std::unique_ptr<gpio::SafetyInputs> guard_{};
  bool door_was_open_ = false;  ///< and the user has not resumed since
  std::string ended_by_{};
};

/// Throws Error(job_failed) for a job that a line has stopped. `reach`: how far it came.
[[noreturn]] void throw_stopped(const std::string& ended_by, const std::string& reach,
                                const std::string& remedy);

}  // namespace lamplock::run
