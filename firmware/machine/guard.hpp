// The guard of a move: it ends where an input changes.
//
// In:  which inputs are watched and for what, their changes with the steps put out by then.
// Out: when the machine is to be stopped; where each axis was when its own switch, or the probe,
//      changed.
// Who: the controller; see() from the main loop with beat and fill masked, as input_changed() is.
//
// A contact bounces, and the machine goes on a little while it brakes: of each input the first
// change counts, until the guard is set anew.
#pragma once

#include "firmware/machine/inputs.hpp"

namespace lamplock::machine {

class Guard {
 public:
  /// Watches these inputs for becoming active, or inactive.
  void watch(InputSet inputs, bool active) {
    watched_ = inputs;
    wanted_ = active;
    met_ = 0;
  }
  /// Watches nothing; what was met stays.
  void drop() { watched_ = 0; }
  bool watches() const { return watched_ != 0; }

  /// True if the machine is to be stopped for this.
  bool see(Input input, bool active, const StepPosition& at) {
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

  /// Inputs that have changed as they were watched for.
  InputSet met() const { return met_; }
  /// Where the machine was when the first of them did.
  const StepPosition& at() const { return at_; }
  /// Where each axis was when its limit did; of others this says nothing.
  const StepPosition& limits_at() const { return limits_at_; }

 private:
  InputSet watched_ = 0, met_ = 0;
  bool wanted_ = true;
  StepPosition at_{}, limits_at_{};
};

}  // namespace lamplock::machine
