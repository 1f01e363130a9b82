// Jogging: the loop round keyboard, pendant, jogger and board.
//
// In:  an open board, the choices of the user, keys and events of a pendant.
// Out: the machine moves; the view shows it.
// Who: `jog`.
//
// One round of the loop takes 2 ms, in which a lost pendant is noticed. A simulated board runs at
// the pace of the wall clock.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "host/pendant/jogger.hpp"
#include "host/pendant/pendant.hpp"
#include "host/pendant/terminal_keys.hpp"
#include "host/run/frontend.hpp"
#include "host/run/supervised_board.hpp"

namespace lamplock::run {

/// The device that moves the machine, and how.
struct JogChoice {
  std::string pendant = "auto";  ///< "none", or an option of pendant_ids
  pendant::KeyMap map;
  std::optional<double> step_mm;
  std::optional<pendant::Mode> mode;
};

/// Keys of a user, as they are pressed.
class JogKeys {
 public:
  virtual ~JogKeys() = default;
  /// The bytes that have come; never waits.
  virtual std::string read() = 0;
  /// No further key will come.
  virtual bool ended() const = 0;
};

/// The view of a user who jogs.
class JogView {
 public:
  virtual ~JogView() = default;
  virtual void show(const pendant::Jogger& jogger) = 0;
  virtual void note(const std::string& text) = 0;
  /// A user can press keys.
  virtual bool has_keyboard() const = 0;
  virtual std::unique_ptr<JogKeys> open_keys() = 0;
};

class JogSession {
 public:
  /// Asks the board for its limits and looks for a pendant. Throws Error: no_device (no answer, no
  /// such pendant, no permission), job_failed (not at rest, reports in inches).
  JogSession(SupervisedBoard& board, const JogChoice& choice, Frontend& frontend, JogView& view);
  /// Stops the machine, also after an exception.
  ~JogSession();
  JogSession(const JogSession&) = delete;
  JogSession& operator=(const JogSession&) = delete;

  /// Until the user leaves. Throws Error: no_device (the board, or the only way to jog, has gone),
  /// job_failed (a line of the computer has stopped the machine).
  void run();

  /// By a signal, not by a key.
  bool interrupted() const { return interrupts_->count() > 0; }
  const pendant::Jogger& jogger() const { return *jogger_; }
  /// Name of the pendant that was used last; empty if there was none.
  const std::string& pendant_name() const { return pendant_name_; }

 private:
  using Clock = std::chrono::steady_clock;

  void find_pendant(bool must_be);
  void use(const pendant::HidInfo& info);
  void take_pendant();
  void take_keys();
  bool is_to_end();
  void stop_and_wait();
  void round();
  void pass_time();

  BoardLink& board_;
  Supervisor& supervisor_;
  const JogChoice& choice_;
  std::unique_ptr<Interrupts> interrupts_;
  JogView& view_;
  std::unique_ptr<JogKeys> keyboard_;
  pendant::TerminalKeys keys_;
  Clock::time_point key_at_{};
  std::optional<pendant::Pendant> pendant_;
  std::string pendant_name_;
  bool pendant_lost_ = false;
  Clock::time_point searched_at_{};
  Clock::time_point passed_until_ = Clock::now();  ///< in simulated time
  std::optional<pendant::Jogger> jogger_;
};

}  // namespace lamplock::run
