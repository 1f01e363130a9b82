// The state of the interpreter between lines: the end of a program, resets, the position.
#include "firmware/program/interpreter.hpp"

namespace lamplock::program {

/// As in grbl: groups 1 to 5, 7 and 12 and spindle and coolant are reset; units, distance of
/// centres, tool length, retract level, path mode and the words F S T are not.
void Interpreter::end_program() {
  if (beside_.active) settle();
  Modal& modal = state_->modal;
  modal.cutter = Cutter::off;
  in_compensation_ = false;
  modal.motion = Motion::line;
  modal.plane = Plane::xy;
  modal.relative = false;
  if (modal.feed_mode != FeedMode::per_minute) modal.feed = 0;
  modal.feed_mode = FeedMode::per_minute;
  modal.system = 0;
  modal.rotation = {};
  modal.spindle = Spindle::off;
  modal.flood = modal.mist = modal.overrides_off = false;
  modal.beat_lock = BeatLock::off;
  modal.pulses = {};
  modal.decimals = 0;
  ignored_ = 0;
  expressions_.clear();
  if (saved_.valid && saved_.restore_at_end) restore_saved();
  find_programmed();
  state_->cycle = {};
  state_->spline = {};
}

void Interpreter::restore_saved() {
  const Modal ended = state_->modal;
  Modal& modal = state_->modal;
  modal = saved_.modal;
  modal.motion = ended.motion;
  modal.tool = ended.tool;
  modal.loaded_tool = ended.loaded_tool;
  modal.spindle = Spindle::off;
  modal.flood = modal.mist = modal.overrides_off = false;
  modal.beat_lock = BeatLock::off;
  modal.pulses = {};
  saved_ = {};
}

/// Without M126 pulses are on only if the settings have a rate; with it, at the current rate.
std::uint32_t Interpreter::pulses_milli() const {
  const Pulses& pulses = state_->modal.pulses;
  if (!options_.laser || pulses.on == Pulses::Switch::off) return 0;
  if (pulses.on == Pulses::Switch::as_set && options_.pulses_milli == 0) return 0;
  return pulses.milli_per_mm == Pulses::as_set ? options_.pulses_milli : pulses.milli_per_mm;
}

std::uint32_t Interpreter::pulse_ns() const {
  const Pulses& pulses = state_->modal.pulses;
  return pulses.length_ns == Pulses::as_set ? options_.pulse_ns : pulses.length_ns;
}

void Interpreter::reset() {
  state_->modal = {};
  state_->modal.tool_length = parameters_.tool_length_e7 != 0;
  saved_ = {};
  users_lines_ = false;
  ignored_ = new_ignored_ = 0;
  expressions_.clear();
  set_position(state_->machine_e7);
}

void Interpreter::set_position(const Place& machine_e7) {
  stand_at(machine_e7);
  plan_.stages = 0;
}

void Interpreter::stand_at(const Place& machine_e7) {
  state_->modal.cutter = Cutter::off;
  beside_.active = false;
  in_compensation_ = users_lines_;
  state_->machine_e7 = machine_e7;
  find_programmed();
  state_->cycle.series = false;
  state_->spline.known = false;
  state_->nurbs = {};
}

/// The coordinate system or its rotation may have changed.
void Interpreter::find_programmed() {
  state_->system_rotation = parameters_.rotation_of(state_->modal.system);
  state_->programmed_e7 = state_->rotations().turned_back(state_->machine_e7);
}

void Interpreter::begin_users_lines() {
  if (beside_.active) settle();
  users_lines_ = in_compensation_ = true;
}

void Interpreter::end_users_lines(const Modal& modal, const Place& machine_e7) {
  const Place from = state_->machine_e7;
  const Modal last = state_->modal;
  users_lines_ = false;
  state_->modal = modal;
  state_->modal.shifted = last.shifted;
  state_->modal.tool_length = last.tool_length;
  state_->modal.loaded_tool = last.loaded_tool;
  set_position(machine_e7);
  if (from == machine_e7) return;
  Place via = machine_e7;
  constexpr std::size_t z = 2;
  if (from[z] < machine_e7[z]) via = from;
  via[z] = from[z] < machine_e7[z] ? machine_e7[z] : from[z];
  plan_.clear();
  plan_.jog = true;  // dark, and not on the beat
  plan_.points[0] = state_->rotations().turned_back(via);
  plan_.add(Stage::via);
  plan_.add(Stage::home);
}

Place Interpreter::work_offset_e7() const {
  Place offset = parameters_.systems_e7[state_->modal.system];
  for (std::size_t i = 0; i < offset.size(); ++i)
    if (state_->modal.shifted) offset[i] += parameters_.shift_e7[i];
  if (state_->modal.tool_length) offset[2] += parameters_.tool_length_e7;
  return offset;
}

}  // namespace lamplock::program
