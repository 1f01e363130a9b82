// An open door, and parking: begin, moves, return.
#include "firmware/machine/controller.hpp"

namespace lamplock::machine {

using wire::HoldReason;
using wire::MachineState;

/// A door has opened, or byte 0x84 was received.
void Controller::open_door() {
  if (parking_.cancel_return()) program_.abort_detour();
  if (state_ == MachineState::home) return fail_homing(alarm_homing_door);
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

/// Programs park, jobs do not.
void Controller::begin_parking() {
  if (program_.begun() && !framed_job() && !beat_locked()) parking_.begin(values_);
}

/// The program is to continue. True if the tool must return first.
bool Controller::come_back() { return state_ == MachineState::door && parking_.request_return(); }

/// Continues when the machine is at rest.
void Controller::work_parking() {
  if (!program_.detour_finished() || program_.batch_waits()) return;
  stepper::Segment move;
  const bool moves = parking_.next(motion_.generator().state(), program_.brake_limits(), move);
  const Masked masked(mask_);
  if (moves) return program_.run_detour(move);
  if (parking_.stage() != Parking::Stage::off) return;
  // Moves of the parked tool do not count for a probe; its contact may have changed meanwhile.
  if (guard_.see(Input::probe, (inputs_ & set_of(Input::probe)) != 0, steps_at_rest()))
    program_.abort_move(true);
  resume();
}

}  // namespace lamplock::machine
