// A program waits for an input (M66).
//
// In:  the event and the time limit; every change of the input, from the board.
// Out: whether the event has occurred, or the time is over.
// Who: the controller, main loop; note_change() with beat and fill masked, as input_changed() is.
//
// An input is on while its contact is closed to ground: with a broken wire it is off, so that a
// wait for "on" ends by its time limit. A change that has already reverted counts as well.
#pragma once

#include "firmware/machine/inputs/inputs.hpp"
#include "firmware/program/action.hpp"

namespace lamplock::machine {

class InputWait {
 public:
  enum class State : std::uint8_t { off, waits, met, late };

  /// Inputs by their number in programs.
  static constexpr Input inputs[] = {Input::aux, Input::probe};

  void begin(program::InputEvent event, std::uint8_t port, bool active, std::uint64_t end_clock) {
    event_ = event;
    input_ = inputs[port];
    end_clock_ = end_clock;
    using program::InputEvent;
    const bool there = event == InputEvent::now || (event == InputEvent::on && active) ||
                       (event == InputEvent::off && !active);
    state_ = there ? State::met : State::waits;
  }
  void end() { state_ = State::off; }

  void note_change(Input input, bool active) {
    if (state_ != State::waits || input != input_) return;
    using program::InputEvent;
    const bool wants_on = event_ == InputEvent::rise || event_ == InputEvent::on;
    if (active == wants_on) state_ = State::met;
  }
  State poll(std::uint64_t clock) {
    if (state_ == State::waits && clock >= end_clock_) state_ = State::late;
    return state_;
  }
  bool begun() const { return state_ != State::off; }
  Input input() const { return input_; }

 private:
  State state_ = State::off;
  program::InputEvent event_ = program::InputEvent::now;
  Input input_ = Input::aux;
  std::uint64_t end_clock_ = 0;
};

/// Inputs that a board has, a bit for each number.
constexpr std::uint8_t program_inputs(unsigned inputs) {
  unsigned bits = 0, bit = 1;
  for (const Input input : InputWait::inputs) {
    if ((inputs & set_of(input)) != 0) bits |= bit;
    bit <<= 1;
  }
  return static_cast<std::uint8_t>(bits);
}

}  // namespace lamplock::machine
