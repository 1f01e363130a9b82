// An open door, and parking behind it: when it begins, its moves, the way back.
#include "firmware/machine/controller.hpp"

namespace lamplock::machine {

using wire::HoldReason;
using wire::MachineState;

/// A door has opened, or 0x84 says so.
void Controller::open_door() {
  if (parking_.stay_away()) program_.break_off_aside();
  if (state_ == MachineState::home) return break_off_homing(alarm_homing_door);
  if (jogging_) return cancel_jog();
  if (state_ != MachineState::run && state_ != MachineState::hold) return;
  state_ = MachineState::door;
  hold_reason_ = HoldReason::none;
  if (moving_) runner_.brake();
  moving_ = false;
  program_.hold();
  shots_.permit(false, BeatReason::door);
  begin_parking();
}

/// Programs park, jobs stay where they are.
void Controller::begin_parking() {
  if (program_.begun() && !framed_job() && !beat_locked()) parking_.begin(values_);
}

/// The program is to go on. True if the tool has to come back first.
bool Controller::come_back() { return state_ == MachineState::door && parking_.call_back(); }

/// Goes on where the machine stands.
void Controller::work_parking() {
  if (!program_.stands_aside() || program_.batch_waits()) return;
  stepper::Segment move;
  const bool moves = parking_.next(motion_.generator().state(), program_.brake_limits(), move);
  const Masked masked(mask_);
  if (moves) return program_.run_aside(move);
  if (parking_.stage() != Parking::Stage::off) return;
  // Moves of the tool while it was away are none of a probe's; its contact may be another one now.
  if (guard_.see(Input::probe, (inputs_ & set_of(Input::probe)) != 0, steps_at_rest()))
    program_.break_off(true);
  resume();
}

}  // namespace lamplock::machine
