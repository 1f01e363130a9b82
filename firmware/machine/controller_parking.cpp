// An open door, and parking: begin, moves, return.
#include "firmware/machine/controller.hpp"

namespace lamplock::machine {

/// Programs park, jobs do not.
void Controller::begin_parking() {
  if (program_.begun() && !machine_.framed() && !beat_locked()) parking_.begin(values_);
}

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
  handle(Event::resume);
}

}  // namespace lamplock::machine
