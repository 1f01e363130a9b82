// Outputs and inputs of programs, drives at rest.
#include "firmware/machine/controller.hpp"

namespace lamplock::machine {

/// Switches off all outputs of programs, the laser as well, and drops pending changes: no light
/// before it is requested again. Beat and fill masked.
void Controller::outputs_off() {
  program_outputs_.all_off();
  reader_.switch_off();
  input_wait_.end();
}

/// No motion is known. In a hold drives stay on: the program continues from there.
bool Controller::drives_may_rest() const {
  return machine_.in(states(State::idle, State::check, State::alarm)) && motion_.at_rest() &&
         program_.drained();
}

/// M66, at rest. True if the program continues.
bool Controller::work_input_wait() {
  const program::IoRequest& wanted = reader_.wait();
  const auto active = [this](Input input) { return (inputs_ & set_of(input)) != 0; };
  if (!input_wait_.begun()) {
    const Masked masked(mask_);
    input_wait_.begin(wanted.event, wanted.port, active(InputWait::inputs[wanted.port]),
                      now_ + std::uint64_t{reader_.wait_us()} * clocks_per_us);
  }
  const InputWait::State state = input_wait_.look(now_);
  if (state == InputWait::State::waits) return false;
  const bool late = state == InputWait::State::late;
  TextLine text;
  text.add("Input ").add(std::int64_t{wanted.port});
  text.add(late ? " not met: " : " ").add(active(input_wait_.input()) ? "on" : "off");
  say(text.view());
  input_wait_.end();
  reader_.end_wait(late);
  if (late) pause();
  return !late;
}

}  // namespace lamplock::machine
