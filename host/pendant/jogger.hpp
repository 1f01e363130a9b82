// Moving a machine by hand: what is done at a pendant or a keyboard, to jogs and commands.
//
// In:  events of a pendant, keys of a terminal, and that one of them has gone. Out: through the jog
//      stream and the talk, lines and real-time bytes; what a display shows; notes for people.
// Who: `lamplock jog`, in a loop that comes round every few ms. No device, no terminal, no clock of
//      its own: tests use it with a simulated board.
//
// Modes: in `step` a click of the wheel or a key is a step. In `continuous` the machine moves at
// the feed while the wheel turns (250 ms without a click end it) or a key repeats, and a ring with
// a spring gives a part of the feed while it is turned. In `feed` the wheel turns the feed
// override. Whatever ends what somebody does ends the jog: the switch turned to another axis,
// another mode, sleep, loss. A jog begins when the machine is idle, and nothing but macros sends
// other G-code than zero; none of it lights a laser.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "host/pendant/board_talk.hpp"
#include "host/pendant/display.hpp"
#include "host/pendant/event.hpp"
#include "host/pendant/jog_stream.hpp"
#include "host/pendant/key_map.hpp"
#include "host/pendant/key_repeat.hpp"

namespace lamplock::pendant {

class Jogger {
 public:
  /// The port must outlive it. `map` is kept.
  Jogger(link::LinePort& port, const JogLimits& limits, KeyMap map);

  /// A pendant is used from now on; with a switch of axes its wheel obeys that alone.
  void use_pendant(bool has_switch);
  /// Something has happened at a pendant.
  void take(const Event& event);
  /// A key of a terminal was pressed, or repeats.
  void press(const std::string& key);
  /// Whoever moves the machine has gone, or wants to: everything that moves because of us ends.
  /// Jogs are cancelled, homing is reset, what else moves is held; until reports say that it
  /// stands.
  void let_go();
  /// One round: hears the board, sends what is due. Throws Error(no_device) as BoardTalk::poll().
  void poll();

  /// Starts with this step of the map's, the nearest one; with this mode.
  void choose_step(double step_mm);
  void set_mode(Mode mode);

  /// Nothing moves because of us, and nothing waits to be sent.
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

  BoardTalk talk_;
  JogStream stream_;
  KeyMap map_;
  KeyRepeat repeat_;
  Selector selector_ = Selector::off;  ///< chosen last, by switch or key
  Selector switch_ = Selector::off;    ///< where that of the pendant stands
  bool has_switch_ = false;
  Rate rate_{};
  bool has_rate_ = false;  ///< the pendant has a switch of steps and speeds
  Mode mode_ = Mode::step;
  std::size_t step_ = 0;  ///< of the map's
  std::deque<std::string> macro_;
  std::string macro_name_;
  bool commands_ = false;  ///< lines other than jogs were sent, and are not done
  bool macro_runs_ = false, quit_ = false;
  std::size_t reports_then_ = 0;  ///< when the last of them was sent or answered
  bool ending_ = false;           ///< they shall not go on
  Time ended_at_{};               ///< when the board was told last
  std::size_t reports_at_ending_ = 0;
  std::size_t restarts_ = 0;  ///< of the board, that have been seen
  std::vector<std::string> notes_;
  std::string last_note_;
  Time noted_at_{};
};

}  // namespace lamplock::pendant
