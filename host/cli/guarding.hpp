// The lines of this computer over what a command does on a real board: e-stop, door, interlock.
//
// In:  --lines, the loop of the command. Out: a board that is held or stopped through the
//      firmware; the error that says so.
// Who: run_job, run_program, `operate`, `console`, `jog`: once in every round of their loops,
//      behind the user's own steering, so that a line has the last word.
//
// How a board is told: jobs by their frames (COMMAND stop; a door holds, and in a job of rows,
// which shines while it brakes for a hold, stops), programs and single lines by a byte: 0x18 for an
// e-stop, which is dark before it brakes, 0x84 for a door, which is dark and keeps the place.
#pragma once

#include <memory>
#include <string>

#include "host/cli/board_options.hpp"
#include "host/cli/line_steering.hpp"
#include "host/cli/steering.hpp"
#include "host/gpio/guard.hpp"
#include "host/gpio/lines.hpp"
#include "host/link/line_port.hpp"
#include "host/link/line_sender.hpp"
#include "host/link/transport.hpp"

namespace lamplock::cli {

/// What an open door does to a job.
enum class AtDoor : std::uint8_t { holds, ends };

/// Watches the lines while one thing runs; without lines, and on simulated boards, nothing.
class Guarding {
 public:
  /// Asks for the lines; time is that of the transport, which must outlive this. Throws Error.
  Guarding(const BoardOptions& options, link::Transport& transport);
  /// The same for any lines.
  Guarding(std::unique_ptr<gpio::Lines> lines, const gpio::LineTable& table,
           link::Transport& transport);

  /// Waits until the inputs are quiet. Throws Error(job_failed) if one is not well.
  void begin(gpio::Work work);
  /// Outputs off; nothing is watched any more.
  void end();

  /// Once in every round, behind the steering.
  void look(Steering& steering, AtDoor at_door);
  void look(LineSteering& steering);
  /// Single lines: what is wrong stops the machine and is thrown as Error(job_failed).
  void look(link::LinePort& port);

  /// Why it ended what ran: "e-stop pressed (GPIO17)"; empty if it did not.
  const std::string& ended_by() const { return ended_by_; }

 private:
  gpio::Verdict look_at_lines();
  template <class Hand, class Waits>
  void guide(Hand& steering, AtDoor at_door, const Waits& waits);
  void went_on();

  link::Transport& transport_;
  std::unique_ptr<gpio::Lines> lines_{};
  std::unique_ptr<gpio::Guard> guard_{};
  bool behind_door_ = false;  ///< it was open, and nobody has gone on since
  std::string ended_by_{};
};

/// The end of something that a line has stopped. `reach`: how far it came; `remedy`: how it goes
/// on. Throws Error(job_failed).
[[noreturn]] void throw_guarded(const std::string& ended_by, const std::string& reach,
                                const std::string& remedy);

}  // namespace lamplock::cli
