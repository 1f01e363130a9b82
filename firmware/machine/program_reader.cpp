#include "firmware/machine/program_reader.hpp"

#include "firmware/machine/program_motion.hpp"

namespace lamplock::machine {

using program::Action;
using program::ActionKind;
using settings::Id;

void ProgramReader::configure(const settings::Values& values) {
  constexpr std::int64_t e7_per_milli = program::one_e7 / 1000;
  options_.axes = values.whole(Id::axes);
  options_.arc_tolerance_e7 = values.milli(Id::arc_tolerance) * e7_per_milli;
  options_.beat_lock = false;  // programs run without the lamp
  options_.laser = values.whole(Id::laser_mode) != 0;
}

program::Fault ProgramReader::begin(std::string_view line) {
  const program::Fault fault = interpreter_.run(line);
  open_ = !fault;
  return fault;
}

program::Fault ProgramReader::begin_jog(std::string_view line, const settings::Values& values,
                                        const StepLimits& space) {
  const program::Place before = interpreter_.machine_e7();
  const program::Fault fault = interpreter_.jog(line);
  if (fault) return fault;
  open_ = true;
  const StepPosition end = steps_of(interpreter_.machine_e7(), values);
  if (axis_outside(end, space, values.whole(Id::axes)) < 0) return fault;
  open_ = false;
  interpreter_.set_position(before);
  return {GcodeError::jog_out_of_travel, 1};
}

bool ProgramReader::next_action() {
  if (pending_) return true;
  pending_ = interpreter_.next(action_);
  prepared_ = false;
  return pending_;
}

ProgramReader::Step ProgramReader::step(const settings::Values& values, const StepLimits& space,
                                        std::uint64_t clock, bool check) {
  if (!open_) return Step::nothing;
  if (paused_) return Step::waits;
  while (next_action()) {
    const Step step = act(values, space, clock, check);
    if (step != Step::done) return step;
  }
  open_ = false;
  return Step::done;
}

ProgramReader::Step ProgramReader::taken() {
  pending_ = false;
  return Step::done;
}

/// Whether the machine stands, for what waits for that. In a hold the program does not go on.
ProgramReader::Step ProgramReader::stand() {
  return runner_.idle() && !runner_.held() ? taken() : Step::waits;
}

ProgramReader::Step ProgramReader::act(const settings::Values& values, const StepLimits& space,
                                       std::uint64_t clock, bool check) {
  if (action_.kind == ActionKind::move) return move(values, space, check);
  if (check) {
    taken();
    return action_.kind == ActionKind::program_end ? Step::ended : Step::done;
  }
  switch (action_.kind) {
    case ActionKind::dwell:
      return dwell(clock);
    case ActionKind::spindle:
    case ActionKind::coolant:
      // A laser's power travels with the moves.
      return options_.laser ? taken() : stand();
    case ActionKind::pause:
      if (stand() == Step::waits) return Step::waits;
      paused_ = true;
      return Step::pauses;
    case ActionKind::program_end:
      return stand() == Step::waits ? Step::waits : Step::ended;
    default:
      return taken();
  }
}

ProgramReader::Step ProgramReader::move(const settings::Values& values, const StepLimits& space,
                                        bool check) {
  if (!prepared_) {
    target_ = line_target(action_, values);
    prepared_ = true;
  }
  if (axis_outside(target_.steps, space, options_.axes) >= 0) {
    if (!check && !runner_.idle()) return Step::waits;  // what came before is well
    drop_line();
    return Step::outside;
  }
  if (!check && !runner_.take(target_)) return Step::waits;
  return taken();
}

ProgramReader::Step ProgramReader::dwell(std::uint64_t clock) {
  if (!dwells_) {
    if (!runner_.idle()) return Step::waits;
    dwells_ = true;
    dwell_end_ = clock + std::uint64_t{action_.time_us} * clocks_per_us;
  }
  if (clock < dwell_end_ || runner_.held()) return Step::waits;
  dwells_ = false;
  return taken();
}

bool ProgramReader::drop_line() {
  const bool was_open = open_;
  open_ = pending_ = paused_ = dwells_ = false;
  interpreter_.set_position(interpreter_.machine_e7());
  return was_open;
}

void ProgramReader::clear() {
  queue_.clear();
  drop_line();
}

void ProgramReader::reset() {
  clear();
  interpreter_.reset();
  astray_ = true;
}

void ProgramReader::find_position(const stepper::MotionState& at, const settings::Values& values) {
  if (!astray_) return;
  program::Place place_e7{};
  for (int a = 0; a < values.whole(Id::axes); ++a)
    place_e7[index(a)] = place_of(at.axis[index(a)].step(), values, a);
  interpreter_.set_position(place_e7);
  astray_ = false;
}

}  // namespace lamplock::machine
