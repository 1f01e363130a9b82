// Whether the machine is at rest, and nothing is under way.
#include "firmware/machine/parts.hpp"

namespace lamplock::machine {

/// No motion is known. In a hold drives stay on: the program continues from there.
bool MachineParts::drives_may_rest() const {
  return machine_.in(states(State::idle, State::check, State::alarm)) && motion_.at_rest() &&
         program_.drained();
}

bool MachineParts::nothing_is_under_way() const {
  return runner_.at_rest() && !shots_.undecided() && !program_unfinished();
}

bool MachineParts::may_be_changed() const {
  return machine_.in(states(State::idle, State::check, State::alarm)) && nothing_is_under_way();
}

/// A start-up line waits: other lines must wait for it.
bool MachineParts::start_up_waits() const {
  for (std::size_t i = start_up_next_; i < start_up_lines; ++i)
    if (!reader_.kept().start_up[i].view().empty()) return true;
  return false;
}

StepPosition MachineParts::steps_at_rest() const {
  const stepper::MotionState at = motion_.generator().state();
  StepPosition steps{};
  for (int a = 0; a < max_axes; ++a) steps[index(a)] = at.axis[index(a)].step();
  return steps;
}

}  // namespace lamplock::machine
