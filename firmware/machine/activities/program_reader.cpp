#include "firmware/machine/activities/program_reader.hpp"

#include <bit>

#include "firmware/machine/activities/program_points.hpp"
#include "firmware/machine/runners/program_motion.hpp"

namespace lamplock::machine {

using program::Action;
using program::ActionKind;
using program::BeatLock;
using settings::Id;

program::Options program_options(const settings::Values& values, bool beat_lock,
                                 ProgramPorts ports) {
  constexpr std::int64_t e7_per_milli = program::one_e7 / 1000;
  program::Options options;
  options.axes = values.whole(Id::axes);
  if (options.axes == max_axes && values.whole(Id::rotary_axis) != 0) {
    options.rotary = 1u << rotary_axis;
    options.shortest_way = values.whole(Id::rotary_axis) == 2;
  }
  options.arc_tolerance_e7 = values.milli(Id::arc_tolerance) * e7_per_milli;
  options.laser = values.whole(Id::laser_mode) != 0;
  options.beat_lock = beat_lock;
  options.probe = options.rows = true;
  options.pulses_milli = static_cast<std::uint32_t>(values.milli(Id::pulses_per_mm));
  options.pulse_ns = static_cast<std::uint32_t>(values.milli(Id::pulse_length));
  options.outputs = ports.outputs;
  options.inputs = ports.inputs;
  return options;
}

void ProgramReader::configure(const settings::Values& values, std::uint8_t channels,
                              ProgramPorts ports) {
  options_ = program_options(values, channels != 0, ports);
  channel_ =
      channels == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(std::countr_zero(channels));
}

void ProgramReader::end_lock() {
  drop_line();
  if (interpreter_.modal().beat_lock == BeatLock::off || interpreter_.run("M131")) return;
  while (interpreter_.next(action_)) {
  }
}

[[gnu::hot]] program::Fault ProgramReader::begin(std::string_view line) {
  const program::Fault fault = interpreter_.run(line);
  open_ = !fault;
  jogs_ = false;
  unchecked_ = open_ && interpreter_.has_extent();
  return fault;
}

/// A curve or a cycle must be inside as a whole before anything of its line acts. Earlier moves are
/// valid and finish first.
ProgramReader::Step ProgramReader::check_extent(const settings::Values& values,
                                                const StepLimits& space, bool check) {
  if (tool_ == ToolChange::over) return Step::returns;
  const program::Extent extent = interpreter_.extent();
  const bool inside = axis_outside(steps_of(extent.low(), values), space, options_.axes) < 0 &&
                      axis_outside(steps_of(extent.high(), values), space, options_.axes) < 0;
  if (!inside && !check && !rests()) return Step::waits;
  unchecked_ = false;
  if (inside) return Step::done;
  drop_line();
  return Step::outside;
}

program::Fault ProgramReader::begin_jog(std::string_view line, const settings::Values& values,
                                        const StepLimits& space) {
  const program::Place before = interpreter_.machine_e7();
  const program::Fault fault = interpreter_.jog(line);
  if (fault) return fault;
  open_ = jogs_ = true;
  const StepPosition end = steps_of(interpreter_.machine_e7(), values);
  if (axis_outside(end, space, values.whole(Id::axes)) < 0) return fault;
  open_ = false;
  interpreter_.set_position(before);
  return {GcodeError::jog_out_of_travel, 1};
}

[[gnu::hot]] bool ProgramReader::next_action() {
  if (pending_) return true;
  pending_ = interpreter_.next(action_);
  if (pending_ && action_.kind == ActionKind::probe) action_.beat_lock = BeatLock::off;
  prepared_ = listed_ = false;
  return pending_;
}

[[gnu::hot]] ProgramReader::Step ProgramReader::step(const settings::Values& values,
                                                     const StepLimits& space, std::uint64_t clock,
                                                     bool check) {
  if (!open_) return Step::nothing;
  if (paused_) return Step::waits;
  if (unchecked_) {
    const Step step = check_extent(values, space, check);
    if (step != Step::done) return step;
  }
  for (bool first = true; next_action(); first = false) {
    // A curve has many moves: no batch may wait for all of them.
    if (!first && runner_.batch_waits()) return Step::waits;
    const Step step = act(values, space, clock, check);
    if (step != Step::done) return step;
  }
  open_ = false;
  return Step::done;
}

[[gnu::hot]] ProgramReader::Step ProgramReader::taken() {
  pending_ = false;
  return Step::done;
}

/// Whether the machine is at rest with every move done. Waiting for that ends a row of points; in a
/// hold the program does not continue.
bool ProgramReader::rests() {
  if (lock_ == BeatLock::off) return runner_.idle() && !runner_.held();
  points_.close();
  return points_.drained();
}

ProgramReader::Step ProgramReader::wait_for_rest() { return rests() ? taken() : Step::waits; }

[[gnu::hot]] ProgramReader::Step ProgramReader::act(const settings::Values& values,
                                                    const StepLimits& space, std::uint64_t clock,
                                                    bool check) {
  if (action_.kind == ActionKind::move || action_.kind == ActionKind::probe)
    return move(values, space, check);
  if (action_.kind == ActionKind::pixels) return pixels(values, check);
  if (check) {
    taken();
    return action_.kind == ActionKind::program_end ? Step::ended : Step::done;
  }
  switch (action_.kind) {
    case ActionKind::dwell:
      return dwell(values, clock);
    case ActionKind::coolant:
      return coolant();
    case ActionKind::output:
      return output();
    case ActionKind::wait_input:
      return rests() ? Step::inputs : Step::waits;
    case ActionKind::spindle:
      return spindle(values);
    case ActionKind::pause:
    case ActionKind::tool_change:
      if (wait_for_rest() == Step::waits) return Step::waits;
      paused_ = true;
      return Step::pauses;
    case ActionKind::program_end:
      if (wait_for_rest() == Step::waits) return Step::waits;
      overrides_off_ = false;
      return Step::ended;
    case ActionKind::overrides:
      if (wait_for_rest() == Step::waits) return Step::waits;
      overrides_off_ = action_.overrides_off;
      return Step::overrides;
    case ActionKind::beat_lock:
      return action_.beat_lock == lock_ ? taken() : wait_for_rest();
    default:
      return taken();
  }
}

/// The power of a laser is part of the moves, but for the light at rest after a line without a
/// move.
ProgramReader::Step ProgramReader::spindle(const settings::Values& values) {
  const bool lights = wants_light(values);
  if (options_.laser && !lights) return taken();
  if (wait_for_rest() == Step::waits) return Step::waits;
  return lights ? Step::lights : Step::done;
}

/// Adds pixels to the next move; with M5 there are none.
ProgramReader::Step ProgramReader::pixels(const settings::Values& values, bool check) {
  if (check || action_.spindle == program::Spindle::off) return taken();
  if (lock_ != BeatLock::off || !planned()) return rests() ? Step::changes : Step::waits;
  return runner_.add_pixels(power_of(action_.speed_milli, values), action_.pixels) ? taken()
                                                                                   : Step::waits;
}

/// Adds the last pixels of the move, or sets the pulses of the next lines.
bool ProgramReader::prepare_beam() {
  if (target_.pulses)
    return runner_.set_pulses(interpreter_.pulses_milli(), interpreter_.pulse_ns());
  if (!target_.pixels || listed_) return true;
  if (!runner_.add_pixels(target_.power, action_.pixels)) return false;
  runner_.end_pixels(target_);
  listed_ = true;
  return true;
}

[[gnu::hot]] ProgramReader::Step ProgramReader::move(const settings::Values& values,
                                                     const StepLimits& space, bool check) {
  if (!prepared_) {
    find_target(action_, values, target_);
    prepared_ = true;
  }
  if (axis_outside(target_.steps, space, options_.axes) >= 0) {
    if (!check && !rests()) return Step::waits;  // earlier moves are valid and finish first
    drop_line();
    return Step::outside;
  }
  if (check) return taken();
  const BeatLock lock = action_.beat_lock;
  if (!probing_ && (lock != lock_ || (lock == BeatLock::off && !planned())))
    return rests() ? Step::changes : Step::waits;
  if (action_.kind == ActionKind::probe) return rests() ? Step::probes : Step::waits;
  if (!take_changes() || !take(values)) return Step::waits;
  from_ = target_.steps;
  return taken();
}

[[gnu::hot]] bool ProgramReader::take(const settings::Values& values) {
  if (lock_ == BeatLock::off)
    return (!(target_.pixels || target_.pulses) || prepare_beam()) && runner_.take(target_);
  if (points_.queue().free() == 0) return false;
  return points_.take(point_target(action_, {from_, target_.steps}, channel_, values));
}

/// Attaches pending output changes to the start of this move. Points on the beat carry none, since
/// the machine is at rest before them and applies the changes then; a jog is no motion of the
/// program.
[[gnu::hot]] bool ProgramReader::take_changes() {
  if (jogs_) return true;
  if (lock_ == BeatLock::off) {
    if (!outputs_.attach(runner_.idle())) return false;
    target_.changes = outputs_.mark();
    return true;
  }
  if (!outputs_.next_waits()) return true;
  if (!rests()) return false;
  outputs_.apply_next();
  return true;
}

ProgramReader::Step ProgramReader::coolant() {
  if (wait_for_rest() == Step::waits) return Step::waits;
  outputs_.set_air(action_.flood || action_.mist);
  return Step::done;
}

ProgramReader::Step ProgramReader::output() {
  if (action_.io.at_once)
    outputs_.set_aux(action_.io.level);
  else
    outputs_.set_next_aux(action_.io.level);
  return taken();
}

/// With M3 a continuous laser may shine in a dwell between cuts and at rest, to pierce and to
/// focus: at most with the power and for the time that the settings permit.
bool ProgramReader::wants_light(const settings::Values& values) const {
  return options_.laser && lock_ == BeatLock::off && action_.beat_lock == lock_ && !action_.rapid &&
         action_.spindle == program::Spindle::constant && values.milli(Id::focus_power) != 0;
}

std::uint16_t ProgramReader::light_power(const settings::Values& values) const {
  return power_of(action_.speed_milli, values);
}

std::uint16_t ProgramReader::max_light_power(const settings::Values& values) const {
  return static_cast<std::uint16_t>(
      wide_product(motion::full_power, static_cast<std::uint32_t>(values.milli(Id::focus_power))) /
      static_cast<std::uint32_t>(settings::range(Id::focus_power).max_milli));
}

std::uint32_t ProgramReader::light_ticks(const settings::Values& values) const {
  const std::uint32_t permitted_us =
      static_cast<std::uint32_t>(values.milli(Id::focus_time)) * 1000;
  const bool dwells = action_.kind == ActionKind::dwell;
  const std::uint32_t us =
      dwells && action_.time_us < permitted_us ? action_.time_us : permitted_us;
  return us * (ticks_per_second / 1'000'000);
}

ProgramReader::Step ProgramReader::dwell(const settings::Values& values, std::uint64_t clock) {
  if (!dwells_) {
    if (!rests()) return Step::waits;
    dwells_ = true;
    dwell_end_ = clock + std::uint64_t{action_.time_us} * clocks_per_us;
    if (wants_light(values)) return Step::lights;
  }
  if (clock < dwell_end_ || runner_.held()) return Step::waits;
  dwells_ = false;
  return taken();
}

bool ProgramReader::drop_line() {
  const bool was_open = open_;
  open_ = pending_ = paused_ = dwells_ = probing_ = unchecked_ = false;
  runner_.drop_pixels();
  interpreter_.set_position(interpreter_.machine_e7());
  return was_open;
}

/// A program that was beside its contour continues without that.
bool ProgramReader::begin_users_lines() {
  if (interpreter_.busy()) return false;
  queue_.set_aside();
  interpreter_.begin_users_lines();
  before_.at_m6 = {interpreter_.modal(), interpreter_.machine_e7()};
  open_ = paused_ = false;
  tool_ = ToolChange::users_lines;
  return true;
}

void ProgramReader::end_tool_change() {
  paused_ = false;
  if (tool_ != ToolChange::users_lines) {
    tool_ = ToolChange::none;
    return;
  }
  queue_.bring_back();
  open_ = unchecked_ = true;
  tool_ = ToolChange::over;
}

void ProgramReader::go_back() {
  interpreter_.end_users_lines(before_.at_m6.modal, before_.at_m6.place_e7);
  put_air();
  jogs_ = unchecked_ = false;
  tool_ = ToolChange::none;
}

std::uint32_t ProgramReader::drop_tool_change() {
  const bool of_user = tool_ == ToolChange::users_lines;
  tool_ = ToolChange::none;
  if (!of_user) return 0;
  const std::uint32_t lines = queue_.lines() + 1;
  queue_.bring_back();
  interpreter_.drop_users_lines();
  return lines;
}

void ProgramReader::clear() {
  drop_tool_change();
  queue_.clear();
  drop_line();
}

void ProgramReader::reset() {
  clear();
  overrides_off_ = false;
  interpreter_.reset();
  off_target_ = true;
}

program::Place ProgramReader::stand_at(const stepper::MotionState& at,
                                       const settings::Values& values) {
  program::Place place_e7{};
  for (int a = 0; a < max_axes; ++a) from_[index(a)] = at.axis[index(a)].step();
  for (int a = 0; a < values.whole(Id::axes); ++a)
    place_e7[index(a)] = place_of(at.axis[index(a)], values, a);
  off_target_ = false;
  return place_e7;
}

void ProgramReader::find_position(const stepper::MotionState& at, const settings::Values& values) {
  if (off_target_) interpreter_.set_position(stand_at(at, values));
}

void ProgramReader::end_probe(const stepper::MotionState& at, const settings::Values& values,
                              bool met, const program::Place& place_e7) {
  interpreter_.stand_at(stand_at(at, values));
  interpreter_.results().probe_met = met;
  interpreter_.results().probe_e7 = place_e7;
  probing_ = false;
  taken();
}

}  // namespace lamplock::machine
