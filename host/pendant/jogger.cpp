#include "host/pendant/jogger.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "host/link/line_port.hpp"

namespace lamplock::pendant {
namespace {

using namespace std::chrono_literals;
namespace realtime = link::realtime;

/// A wheel without a click for this time counts as released.
constexpr Time wheel_silence = 250ms;
/// A spring ring reports changes only: a ring that is held still cannot be distinguished from a
/// dead receiver. To move for longer, the user moves the ring a little.
constexpr Time max_spring_time = 30s;
constexpr double max_spring_position = 7;
constexpr double percent = 0.01;
/// A note is repeated only after its cause was absent for this time.
constexpr Time note_interval = 2s;
/// A click of the wheel as a knob is 1 %; a fast turn is limited.
constexpr int max_knob_clicks = 10;

/// Limits a number to the range of displays; a board may report any value.
int shown_number(double value) {
  constexpr double most = 65535;
  return std::isfinite(value) ? static_cast<int>(std::clamp(value, 0.0, most)) : 0;
}

Selector selector_of(int axis) { return static_cast<Selector>(axis + 1); }

}  // namespace

Jogger::Jogger(link::LinePort& port, const JogLimits& limits, KeyMap map)
    : talk_(port), stream_(talk_, limits), map_(std::move(map)) {
  choose_step(0.1);
}

void Jogger::use_pendant(bool has_switch) {
  has_switch_ = has_switch;
  switch_ = Selector::off;
  has_rate_ = false;
}

void Jogger::take(const Event& event) {
  switch (event.kind) {
    case Event::Kind::key_down:
      if (event.key == Key::ambiguous)
        return note("this key differs between models: set hb04_keys = 16 or 18 in [pendant]");
      if (const auto bound = map_.keys.find(event.key); bound != map_.keys.end())
        act(bound->second, "");
      return;
    case Event::Kind::key_up:
      return;
    case Event::Kind::selector:
      switch_ = event.selector;
      has_switch_ = true;
      return choose(event.selector);
    case Event::Kind::rate:
      rate_ = event.rate;
      has_rate_ = true;
      if (stream_.runs()) stream_.stop();
      return;
    case Event::Kind::wheel:
      return move_wheel(event.count);
    case Event::Kind::spring:
      return turn_spring(event.count);
    case Event::Kind::asleep:
      stop_motion();
      return note("the pendant is asleep");
    case Event::Kind::awake:
      return note("the pendant is awake");
  }
}

void Jogger::press(const std::string& key) {
  const auto bound = map_.keyboard.find(key);
  // Any other key, even an unused one, shows that the key before was released.
  if (bound == map_.keyboard.end()) {
    stream_.stop();
    return note(fmt::format("'{}' has no action; {}", key, keys_text));
  }
  act(bound->second, key);
}

void Jogger::stop_motion() {
  stream_.stop();
  if (!commands_ && !homes()) return;
  macro_.clear();
  talk_.drop_lines();  // those queued in this round
  ending_ = true;
  reports_at_ending_ = machine().reports;
  end_commands();
}

void Jogger::poll() {
  for (const Answered& answer : talk_.poll(stream_.moves() || commands_)) {
    stream_.take(answer);
    if (answer.kind == LineKind::command) reports_then_ = machine().reports;
    if (answer.error == 0) continue;
    const std::string error = link::error_text(answer.error);
    if (answer.kind == LineKind::jog) {
      note(error);
      continue;
    }
    note(fmt::format("{}: {}", answer.line, error));
    macro_.clear();
  }
  if (talk_.restarts() != restarts_) macro_.clear();
  restarts_ = talk_.restarts();
  for (const std::string& message : talk_.take_messages()) {
    if (message.starts_with("ALARM")) macro_.clear();
    note(message);
  }
  stream_.poll();
  continue_macro();
  settle_commands();
  keep_ending();
}

void Jogger::choose_step(double step_mm) {
  const auto farther = [step_mm](double a, double b) {
    return std::fabs(a - step_mm) < std::fabs(b - step_mm);
  };
  const auto nearest = std::min_element(map_.steps_mm.begin(), map_.steps_mm.end(), farther);
  step_ = static_cast<std::size_t>(nearest - map_.steps_mm.begin());
}

void Jogger::set_mode(Mode mode) {
  if (mode != mode_ && stream_.runs()) stream_.stop();
  mode_ = mode;
}

bool Jogger::rests() const { return !stream_.moves() && !commands_; }

Display Jogger::display() const {
  Display shown;
  const std::vector<double> work = machine().place(true), place = machine().place(false);
  std::copy_n(work.begin(), std::min(work.size(), shown.work_mm.size()), shown.work_mm.begin());
  std::copy_n(place.begin(), std::min(place.size(), shown.machine_mm.size()),
              shown.machine_mm.begin());
  shown.selector = selector_;
  shown.mode = mode_;
  shown.step_mm = step_mm();
  if (machine().overrides.size() == 3) {
    shown.feed_percent = machine().overrides[0];
    shown.power_percent = machine().overrides[2];
  }
  shown.feed_mm_min = shown_number(machine().status.feed);
  shown.power = shown_number(machine().status.speed);
  shown.alarm = machine().status.is("Alarm");
  return shown;
}

std::vector<std::string> Jogger::take_notes() { return std::exchange(notes_, {}); }

/// A repeated note is shown once.
void Jogger::note(const std::string& text) {
  const Time now = talk_.now();
  const bool again = text == last_note_ && now - noted_at_ < note_interval;
  noted_at_ = now;
  if (again) return;
  last_note_ = text;
  notes_.push_back(text);
}

// --- the wheel --------------------------------------------------------------------------------

/// The selected axis, if the machine has it; -1 for none.
int Jogger::axis() const {
  const int axis = static_cast<int>(selector_) - static_cast<int>(Selector::x);
  return axis >= 0 && axis < std::min(stream_.limits().axes, max_axes) ? axis : -1;
}

double Jogger::step_mm() const { return has_rate_ ? rate_.step_mm : map_.steps_mm[step_]; }

double Jogger::wheel_feed_mm_min() const {
  return map_.feed_mm_min * (has_rate_ ? rate_.percent * percent : 1);
}

void Jogger::move_wheel(int clicks) {
  if (has_switch_ && switch_ != selector_) return note("turn the axis switch first");
  const bool knob = mode_ == Mode::feed || selector_ == Selector::feed || rate_.lead;
  if (selector_ == Selector::off) return;
  if (selector_ == Selector::power)
    return turn_override(clicks, realtime::power_plus_1, realtime::power_minus_1);
  if (knob) return turn_override(clicks, realtime::feed_plus_1, realtime::feed_minus_1);
  if (axis() < 0 || clicks == 0) return;
  if (mode_ == Mode::step) return jog_steps(axis(), clicks);
  jog_on(axis(), clicks > 0 ? 1 : -1, wheel_feed_mm_min(), talk_.now() + wheel_silence);
}

void Jogger::turn_spring(int place) {
  if (place == 0) return stream_.stop();
  if (axis() < 0) return note("select an axis first");
  jog_on(axis(), place > 0 ? 1 : -1, map_.feed_mm_min * std::abs(place) / max_spring_position,
         talk_.now() + max_spring_time);
}

void Jogger::turn_override(int clicks, std::uint8_t more, std::uint8_t less) {
  const int count = std::min(std::abs(clicks), max_knob_clicks);
  for (int i = 0; i < count; ++i) talk_.send_byte(clicks > 0 ? more : less);
}

void Jogger::jog_steps(int axis, int clicks) {
  if (step_mm() > 0 && may_jog()) stream_.step(axis, step_mm(), clicks, map_.feed_mm_min);
}

void Jogger::jog_on(int axis, int sign, double feed_mm_min, Time until) {
  if (!may_jog()) return;
  Direction direction{};
  direction[index(axis)] = sign;
  stream_.run(direction, feed_mm_min, until);
}

void Jogger::choose(Selector selector) {
  if (selector == selector_) return;
  if (stream_.runs() || selector == Selector::off) stream_.stop();
  selector_ = selector;
}

void Jogger::change_step(int by, bool round) {
  const auto count = static_cast<int>(map_.steps_mm.size());
  const int wanted = static_cast<int>(step_) + by;
  step_ =
      static_cast<std::size_t>(round ? (wanted + count) % count : std::clamp(wanted, 0, count - 1));
}

// --- keys -------------------------------------------------------------------------------------

void Jogger::act(const Binding& binding, const std::string& key) {
  const Action action = binding.action;
  if (!binding.macro && jog_key(action, key)) return;
  // Another key of a keyboard: the key before was released.
  if (!key.empty() && stream_.runs()) stream_.stop();
  if (binding.macro) return begin_macro(*binding.macro);
  if (!act_on_axes(action)) act(action);
}

void Jogger::act(Action action) {
  switch (action) {
    case Action::stop:
      return stop();
    case Action::reset:
      return reset();
    case Action::start:
      return talk_.send_byte(realtime::resume);
    case Action::hold:
      stream_.stop();  // a spring ring that is still turned would begin again
      return talk_.send_byte(realtime::hold);
    case Action::start_pause:
      return start_or_pause();
    case Action::unlock:
      return send("$X");
    case Action::feed_full:
      return talk_.send_byte(realtime::feed_full);
    case Action::feed_plus:
      return talk_.send_byte(realtime::feed_plus_10);
    case Action::feed_minus:
      return talk_.send_byte(realtime::feed_minus_10);
    case Action::power_full:
      return talk_.send_byte(realtime::power_full);
    case Action::power_plus:
      return talk_.send_byte(realtime::power_plus_10);
    case Action::power_minus:
      return talk_.send_byte(realtime::power_minus_10);
    case Action::next_step:
      return change_step(1, true);
    case Action::greater_step:
      return change_step(1, false);
    case Action::smaller_step:
      return change_step(-1, false);
    case Action::next_mode:
      return set_mode(static_cast<Mode>((static_cast<int>(mode_) + 1) % 3));
    case Action::mode_step:
      return set_mode(Mode::step);
    case Action::mode_continuous:
      return set_mode(Mode::continuous);
    case Action::mode_feed:
      return set_mode(Mode::feed);
    case Action::quit:
      quit_ = true;
      return stop_motion();
    default:
      return;
  }
}

/// Actions for axes and positions; false for other actions.
bool Jogger::act_on_axes(Action action) {
  switch (action) {
    case Action::home:
      if ((machine().status.is("Alarm") && !ending_) || may_command()) send("$H");
      return true;
    case Action::go_to_zero:
      go_somewhere("G90G21X0Y0");
      return true;
    case Action::safe_z:
      if (map_.safe_z_mm)
        go_somewhere(fmt::format("G53G90G21Z{:.3f}", *map_.safe_z_mm));
      else
        note("the safe height of Z is unknown: set safe_z in [pendant]");
      return true;
    case Action::next_axis:
      choose(selector_of((axis() + 1) % std::min(stream_.limits().axes, max_axes)));
      return true;
    case Action::axis_off:
      choose(Selector::off);
      return true;
    default:
      break;
  }
  if (action >= Action::zero && action <= Action::zero_all) {
    set_zero(action);
    return true;
  }
  if (action < Action::axis_x || action > Action::axis_a) return false;
  choose(selector_of(static_cast<int>(action) - static_cast<int>(Action::axis_x)));
  return true;
}

/// Keys that move an axis; false for other keys. Keys of a pendant do not repeat: they make steps.
bool Jogger::jog_key(Action action, const std::string& key) {
  if (action < Action::jog_x_plus || action > Action::jog_a_minus) return false;
  const int number = static_cast<int>(action) - static_cast<int>(Action::jog_x_plus);
  const int axis = number / 2, sign = number % 2 == 0 ? 1 : -1;
  if (axis >= stream_.limits().axes) {
    note(fmt::format("the machine has no axis {}", axis_letters[index(axis)]));
    return true;
  }
  const KeyRepeat::Press press = repeat_.press(key, talk_.now());
  if (press.held && mode_ != Mode::step) {
    jog_on(axis, sign, map_.feed_mm_min, press.until);
  } else {
    if (stream_.runs()) stream_.stop();
    if (may_jog()) stream_.step(axis, map_.steps_mm[step_], sign, map_.feed_mm_min);
  }
  return true;
}

void Jogger::go_somewhere(const std::string& words) {
  if (!may_jog()) return;
  if (stream_.moves()) return note("wait until the machine is at rest");
  stream_.go(words, map_.feed_mm_min);
}

void Jogger::set_zero(Action action) {
  std::string words;
  const int one =
      action == Action::zero ? axis() : static_cast<int>(action) - static_cast<int>(Action::zero_x);
  for (int a = 0; a < std::min(stream_.limits().axes, max_axes); ++a)
    if (action == Action::zero_all || a == one)
      words += fmt::format(" {}0", axis_letters[index(a)]);
  if (words.empty()) return note("select an axis first");
  // G54, as in `lamplock operate zero`.
  if (may_command()) send("G10 L20 P1" + words);
}

// --- conditions -------------------------------------------------------------------------------

/// As in grbl, a jog may begin in the states Idle and Jog only.
bool Jogger::may_jog() {
  const link::BoardStatus& status = machine().status;
  if (commands_) return false;
  if (status.is("Idle") || status.is("Jog")) return true;
  if (!status.state.empty())
    note(fmt::format("the machine cannot jog in state {}{}", status.state,
                     status.is("Alarm") ? ": home it or unlock it (keys h, u)"
                     : status.waits()   ? ": resume it (key ~)"
                                        : ""));
  return false;
}

bool Jogger::may_command() {
  if (machine().status.is("Idle") && rests()) return true;
  note("wait until the machine is idle");
  return false;
}

}  // namespace lamplock::pendant
