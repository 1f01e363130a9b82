// Manual motion: converts user actions at a pendant or a keyboard to jogs and commands.
//
// In:  events of a pendant, keys of a terminal, the loss of either. Out: through the jog stream and
//      the talk, lines and real-time bytes; contents of a display; notes for the user.
// Who: `lamplock jog`, in a loop with a period of a few ms. No device, no terminal, no clock of its
//      own, so that tests can use it with a simulated board.
//
// Modes: in `step` a click of the wheel or a key is a step. In `continuous` the machine moves at
// the feed while the wheel turns (until 250 ms without a click) or a key repeats, and a spring ring
// sets a fraction of the feed while it is turned. In `feed` the wheel changes the feed override.
// The end of the user's action ends the jog: another axis or mode selected, sleep or loss of the
// pendant. A jog begins only when the machine is idle. Except in macros, setting zero is the only
// G-code sent, and no line turns on the laser.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "host/pendant/board_dialog.hpp"
#include "host/pendant/display.hpp"
#include "host/pendant/event.hpp"
#include "host/pendant/jog_stream.hpp"
#include "host/pendant/key_map.hpp"
#include "host/pendant/key_repeat.hpp"

namespace lamplock::pendant {

/// The keys of a terminal that a user needs first, in one line.
inline constexpr const char* keys_text =
    "keys: arrows PgUp/Dn move, m mode, + - step, h home, ! hold, Esc stop, q quit";

class Jogger {
 public:
  /// The port must outlive it. `map` is kept.
  Jogger(link::LinePort& port, const JogLimits& limits, KeyMap map);

  /// A pendant is used from now on; with an axis switch, only the switch selects its wheel's axis.
  void use_pendant(bool has_switch);
  /// An event of a pendant.
  void take(const Event& event);
  /// A key of a terminal was pressed, or repeats.
  void press(const std::string& key);
  /// The user, a pendant or the terminal has left: ends all motion that this object has started.
  /// Cancels jogs, resets during homing, holds other motion, until reports say that the machine is
  /// at rest.
  void stop_motion();
  /// One round: reads from the board, sends due lines. Throws Error(no_device) as
  /// BoardDialog::poll().
  void poll();

  /// Selects the nearest step of the map.
  void choose_step(double step_mm);
  void set_mode(Mode mode);

  /// No motion of this object is under way, and no line waits to be sent.
  bool rests() const;
  bool wants_to_quit() const { return quit_; }
  const MachineNow& machine() const { return talk_.machine(); }
  const JogCounts& counts() const { return stream_.counts(); }
  Display display() const;
  /// Notes and messages since the last call.
  std::vector<std::string> take_notes();

 private:
  void move_wheel(int clicks);
  void turn_spring(int place);
  void act(const Binding& binding, const std::string& key);
  void act(Action action);
  bool act_on_axes(Action action);
  bool jog_key(Action action, const std::string& key);
  void jog_steps(int axis, int clicks);
  void jog_on(int axis, int sign, double feed_mm_min, Time until);
  void go_somewhere(const std::string& words);
  void set_zero(Action action);
  void send(const std::string& line);
  void settle_commands();
  void begin_macro(std::size_t number);
  void continue_macro();
  bool homes() const;
  void end_commands();
  void keep_ending();
  void stop();
  void start_or_pause();
  void reset();
  void choose(Selector selector);
  void change_step(int by, bool round);
  void turn_override(int clicks, std::uint8_t more, std::uint8_t less);
  bool may_jog();
  bool may_command();
  int axis() const;
  double wheel_feed_mm_min() const;
  double step_mm() const;
  void note(const std::string& text);

  BoardDialog talk_;
  JogStream stream_;
  KeyMap map_;
  KeyRepeat repeat_;
  Selector selector_ = Selector::off;  ///< selected last, by switch or key
  Selector switch_ = Selector::off;    ///< position of the pendant's axis switch
  bool has_switch_ = false;
  Rate rate_{};
  bool has_rate_ = false;  ///< the pendant has a switch of steps and speeds
  Mode mode_ = Mode::step;
  std::size_t step_ = 0;  ///< index in map_.steps_mm
  std::deque<std::string> macro_;
  std::string macro_name_;
  bool commands_ = false;  ///< lines other than jogs were sent and are not completed
  bool macro_runs_ = false, quit_ = false;
  std::size_t reports_then_ = 0;  ///< count of reports when the last one was sent or answered
  bool ending_ = false;           ///< the commands are being stopped
  Time ended_at_{};               ///< when the board was last sent a stop
  std::size_t reports_at_ending_ = 0;
  std::size_t restarts_ = 0;  ///< of the board, already handled
  std::vector<std::string> notes_;
  std::string last_note_;
  Time noted_at_{};
};

}  // namespace lamplock::pendant
