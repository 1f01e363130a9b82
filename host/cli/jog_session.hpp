// Somebody moves a machine by hand: the loop round keyboard, pendant, jogger and board.
//
// In:  an open board, what the user has chosen. Out: the machine moves; how it ended.
// Who: `lamplock jog`.
//
// The loop comes round every 2 ms: that is how long a lost pendant is not noticed. A simulated
// board runs as fast as the wall clock.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "host/cli/guarded_board.hpp"
#include "host/cli/interrupt.hpp"
#include "host/cli/jog_screen.hpp"
#include "host/cli/raw_terminal.hpp"
#include "host/pendant/jogger.hpp"
#include "host/pendant/pendant.hpp"
#include "host/pendant/terminal_keys.hpp"

namespace lamplock::cli {

/// What somebody wants to move it with, and how.
struct JogChoice {
  std::string pendant = "auto";  ///< "none", or an option of pendant_ids
  pendant::KeyMap map;
  std::optional<double> step_mm;
  std::optional<pendant::Mode> mode;
};

class JogSession {
 public:
  /// Asks the board for its limits and looks for a pendant. Throws Error: no_device (no answer, no
  /// such pendant, no permission), job_failed (not at rest, reports in inches).
  JogSession(GuardedBoard& board, const JogChoice& choice, Console& console);
  /// Whatever happened: the machine is told to stop.
  ~JogSession();
  JogSession(const JogSession&) = delete;
  JogSession& operator=(const JogSession&) = delete;

  /// Until the user leaves. Throws Error: no_device (the board, or the only way to jog, has gone),
  /// job_failed (a line of the computer has stopped the machine).
  void run();

  /// By a signal, not by a key.
  bool interrupted() const { return interrupt_.count() > 0; }
  const pendant::Jogger& jogger() const { return *jogger_; }
  /// Name of the pendant that was used last; empty if there was none.
  const std::string& pendant_name() const { return pendant_name_; }

 private:
  using Clock = std::chrono::steady_clock;

  void look_for_pendant(bool must_be);
  void use(const pendant::HidInfo& info);
  void take_pendant();
  void take_keys();
  bool shall_end();
  void come_to_rest();
  void round();
  void pass_time();

  BoardLink& board_;
  Guarding& guarding_;
  const JogChoice& choice_;
  Interrupt interrupt_;
  std::optional<RawTerminal> terminal_;
  pendant::TerminalKeys keys_;
  Clock::time_point key_at_{};
  std::optional<pendant::Pendant> pendant_;
  std::string pendant_name_;
  bool pendant_lost_ = false;
  Clock::time_point looked_at_{};
  Clock::time_point passed_until_ = Clock::now();  ///< simulated time has been let pass
  std::optional<pendant::Jogger> jogger_;
  JogScreen screen_;
};

}  // namespace lamplock::cli
