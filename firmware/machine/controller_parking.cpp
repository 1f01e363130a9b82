// Parking behind an open door: when it begins, its moves, the way back.
#include "firmware/machine/controller.hpp"

namespace lamplock::machine {

using wire::MachineState;

/// A door has opened: programs park, jobs stay where they are.
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
  resume();
}

}  // namespace lamplock::machine
