// The guard of a move: the move ends when an input changes.
//
// In:  the watched inputs and their level, their changes with the steps put out so far.
// Out: when the machine must stop; where each axis was when its own switch, or the probe, changed.
// Who: the controller; check_change() from the main loop with beat and fill masked, as
// input_changed() is.
//
// A contact bounces, and the machine moves on while it brakes: of each input the first change
// counts, until the guard is set again.
#pragma once

#include "firmware/machine/inputs/inputs.hpp"

namespace lamplock::machine {

class MoveGuard {
 public:
  /// Watches these inputs for becoming active, or inactive.
  void watch(InputSet inputs, bool active) {
    watched_ = inputs;
    wanted_ = active;
    met_ = 0;
  }
  /// Watches nothing; keeps the result.
  void drop() { watched_ = 0; }
  bool watches() const { return watched_ != 0; }

  /// True if the machine must stop because of this change.
  bool check_change(Input input, bool active, const StepPosition& at) {
    const InputSet bit = set_of(input);
    if ((watched_ & bit) == 0 || (met_ & bit) != 0 || active != wanted_) return false;
    if (met_ == 0) at_ = at;
    if (is_limit(input))
      for (int a = 0; a < max_axes; ++a)
        if (input == limit_of(a) || input == Input::limit_chain)
          limits_at_[index(a)] = at[index(a)];
    met_ = static_cast<InputSet>(met_ | bit);
    return true;
  }

  /// Inputs that have changed to the watched level.
  InputSet met() const { return met_; }
  /// Position of the machine at the first of these changes.
  const StepPosition& at() const { return at_; }
  /// Position of each axis when its limit changed; undefined for the others.
  const StepPosition& limits_at() const { return limits_at_; }

 private:
  InputSet watched_ = 0, met_ = 0;
  bool wanted_ = true;
  StepPosition at_{}, limits_at_{};
};

}  // namespace lamplock::machine
