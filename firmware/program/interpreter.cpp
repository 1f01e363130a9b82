#include "firmware/program/interpreter.hpp"

#include <algorithm>
#include <bit>
#include <new>
#include <utility>

#include "firmware/program/rotary.hpp"

namespace lamplock::program {

[[gnu::hot]] Fault Interpreter::run(std::string_view line) {
  Statement statement(options_, parameters_, saved_, expressions_, *state_, *next_, plan_);
  const Fault fault = statement.check(line);
  if (in_compensation_ || plan_.sets_cutter) [[unlikely]]
    return run_compensated(statement, line, fault);
  if (!fault) take_over(statement);
  if (expressions_.has_assignments()) expressions_.end_line(!fault);
  return fault;
}

Fault Interpreter::jog(std::string_view line) {
  if (state_->modal.cutter != Cutter::off) return {GcodeError::compensation_on, 1};
  if (state_->nurbs.count != 0) return {GcodeError::not_idle, 1};
  const bool was_beside = beside_.active;
  if (was_beside) settle();
  Statement statement(options_, parameters_, saved_, expressions_, *state_, *next_, plan_);
  const Fault fault = statement.check_jog(line);
  if (!fault)
    take_over(statement);
  else if (was_beside)
    go_beside();
  return fault;
}

[[gnu::hot]] void Interpreter::take_over(const Statement& statement) {
  if (statement.saving() != Block::no_code) [[unlikely]]
    save(statement.saving());
  std::swap(state_, next_);
  if (statement.ignored() != 0) ignore(statement.ignored());
  if (statement.changes().rows != 0) [[unlikely]]
    change_parameters(statement.changes());
  if ((plan_.weights_e6[0] | plan_.weights_e6[1]) != 0) [[unlikely]]
    add_nurbs_points();
  if (plan_.has(Stage::curve)) begin_curve();
  if (plan_.has(Stage::cycle)) work_.cycle.begin(statement.cycle());
  if (plan_.pieces != 0) begin_pieces(statement.powers());
}

/// M70, M71 and M73.
void Interpreter::save(std::uint16_t code) {
  switch (code) {
    case 70:
    case 73:
      saved_ = {state_->modal, true, code == 73};
      break;
    case 71:
      saved_ = {};
      break;
    default:
      break;
  }
}

void Interpreter::ignore(std::uint8_t words) {
  new_ignored_ = static_cast<std::uint8_t>(new_ignored_ | (words & ~ignored_));
  ignored_ = static_cast<std::uint8_t>(ignored_ | (words & ~message_bit));
}

/// Copies the powers: the line no longer exists when its pieces are made.
void Interpreter::begin_pieces(std::string_view powers) {
  std::copy(powers.begin(), powers.end(), work_.pieces.text.begin());
  work_.pieces.powers = PowerList({work_.pieces.text.data(), powers.size()});
  work_.pieces.returned = 0;
}

CurvePlane Interpreter::curve_plane() const {
  const PlaneAxes axes = axes_of(state_->modal.plane);
  return {axes.first, axes.second, axes.normal};
}

ArcRequest Interpreter::arc_request() const {
  return {plan_.start,
          state_->programmed_e7,
          plan_.points[0],
          curve_plane(),
          plan_.motion == Motion::arc_clockwise,
          plan_.turns,
          options_.arc_tolerance_e7};
}

SplineRequest Interpreter::spline_request() const {
  return {plan_.start,           plan_.points[0], plan_.points[1],
          state_->programmed_e7, curve_plane(),   options_.arc_tolerance_e7};
}

NurbsRequest Interpreter::nurbs_request() const {
  return {plan_.start, state_->programmed_e7, &work_.nurbs, curve_plane(),
          options_.arc_tolerance_e7};
}

/// Of the line; the first one begins a block.
void Interpreter::add_nurbs_points() {
  const auto [start_weight_e6, weight_e6] = plan_.weights_e6;
  if (start_weight_e6 != 0) {
    NurbsPoints* const begun = new (&work_.nurbs) NurbsPoints;
    begun->order = state_->nurbs.order;
    begun->points[0] = {{plan_.start[0], plan_.start[1]}, start_weight_e6};
    begun->count = 1;
  }
  if (weight_e6 != 0)
    work_.nurbs.points[work_.nurbs.count++] = {{plan_.points[0][0], plan_.points[0][1]}, weight_e6};
}

void Interpreter::begin_curve() {
  if (is_arc(plan_.motion))
    curve_.begin_arc(arc_request());
  else if (plan_.motion == Motion::nurbs)
    curve_.begin_nurbs(nurbs_request());
  else
    curve_.begin_spline(spline_request());
  if (plan_.time_us != 0 || plan_.is_rotary_arc())
    share_.begin(plan_.start, curve_.length_e7(), curve_.pieces(), plan_.time_us);
}

Extent Interpreter::extent() const {
  const Rotations rotations = state_->rotations();
  if (plan_.has(Stage::held)) return compensated_extent();
  if (plan_.has(Stage::cycle)) return extent_of(work_.cycle.request(), rotations);
  if (plan_.motion == Motion::nurbs) return extent_of(nurbs_request(), rotations);
  if (plan_.has(Stage::curve))
    return is_arc(plan_.motion) ? extent_of(arc_request(), rotations)
                                : extent_of(spline_request(), rotations);
  Extent extent(state_->machine_e7);
  extent.add(rotations.turned(plan_.points[0]));
  return extent;
}

void Interpreter::change_parameters(const Changes& changes) {
  if (changes.has(ParameterRow::tool_length)) parameters_.tool_length_e7 = changes.tool_length_e7;
  if (changes.has(ParameterRow::tools)) parameters_.tools.set(changes.tool);
  if (changes.has(ParameterRow::home_g28)) parameters_.home_g28_e7 = changes.place;
  if (changes.has(ParameterRow::home_g30)) parameters_.home_g30_e7 = changes.place;
  if (changes.has(ParameterRow::shift)) parameters_.shift_e7 = changes.place;
  for (std::size_t i = 0; i < parameters_.systems_e7.size(); ++i)
    if ((changes.rows >> i & 1u) != 0) {
      parameters_.systems_e7[i] = changes.place;
      parameters_.rotations_e7[i] = changes.rotation_e7;
    }
  parameters_.changed |= changes.rows;
}

// --- actions ----------------------------------------------------------------------------------

[[gnu::hot]] bool Interpreter::next(Action& action) {
  while (plan_.stages != 0)
    if (give(static_cast<Stage>(std::countr_zero(plan_.stages)), action)) return true;
  return false;
}

/// In place: actions are large.
[[gnu::hot]] void Interpreter::begin_action(Action& action, ActionKind kind) const {
  action = {};
  action.kind = kind;
  action.line = plan_.line;
  action.flood = state_->modal.flood;
  action.mist = state_->modal.mist;
  action.speed_milli = state_->modal.speed_milli;
  if (!plan_.jog) {
    action.spindle = state_->modal.spindle;
    action.beat_lock = state_->modal.beat_lock;
  }
}

[[gnu::hot]] void Interpreter::fill_move(Action& action, bool rapid) const {
  begin_action(action, ActionKind::move);
  action.rapid = rapid;
  if (!rapid) {
    action.feed_um_min = plan_.feed_um_min;
    action.timed = plan_.time_us != 0;
    action.time_us = plan_.time_us;
  }
  if (plan_.jog) return;
  action.pulses = pulses();
  action.exact_stop = plan_.exact_stop || state_->modal.path == PathMode::stop;
  action.blend_um = state_->modal.blend_um;
}

[[gnu::hot]] bool Interpreter::give(Stage stage, Action& action) {
  switch (stage) {
    case Stage::held:
      return give_held(action);
    case Stage::corner:
      return give_corner(action);
    case Stage::output:
    case Stage::wait_input:
      return give_io(stage, action);
    case Stage::tool_change:
      begin_action(action, ActionKind::tool_change);
      break;
    case Stage::spindle:
      begin_action(action, ActionKind::spindle);
      action.rapid = plan_.moves() || !is_feed(state_->modal.motion);
      break;
    case Stage::coolant:
      begin_action(action, ActionKind::coolant);
      break;
    case Stage::overrides:
      begin_action(action, ActionKind::overrides);
      action.overrides_off = state_->modal.overrides_off;
      break;
    case Stage::beat_lock:
      begin_action(action, ActionKind::beat_lock);
      break;
    case Stage::dwell:
      return give_dwell(action);
    case Stage::via:
    case Stage::home:
    case Stage::move:
      return give_move(stage, action);
    case Stage::curve:
      return give_curve(action);
    case Stage::cycle:
      return give_cycle(action);
    case Stage::stop:
      return give_stop(action);
  }
  done(stage);
  return true;
}

bool Interpreter::give_io(Stage stage, Action& action) {
  begin_action(action, stage == Stage::output ? ActionKind::output : ActionKind::wait_input);
  action.io = plan_.io;
  action.time_us = plan_.wait_us;
  done(stage);
  return true;
}

bool Interpreter::give_dwell(Action& action) {
  begin_action(action, ActionKind::dwell);
  action.rapid = !is_feed(state_->modal.motion);
  action.time_us = plan_.dwell_us;
  done(Stage::dwell);
  return true;
}

/// The previous state is still there, and contains the start of the line.
[[gnu::hot]] bool Interpreter::give_piece(Action& action) {
  PowerRun run;
  work_.pieces.powers.next(run);  // checked before
  work_.pieces.returned += run.pieces;
  const std::uint32_t returned = work_.pieces.returned;
  fill_move(action, false);
  action.speed_milli = run.speed_milli;
  action.programmed_end = returned >= plan_.pieces || run.pieces == 0;
  action.target_e7 = state_->machine_e7;
  const bool row = one_row() && run.pieces != plan_.pieces;
  if (row) action.pixels = static_cast<std::uint16_t>(run.pieces);
  if (action.programmed_end) {
    done(Stage::move);
    return true;
  }
  action.exact_stop = false;
  if (row) {
    action.kind = ActionKind::pixels;
    return true;
  }
  for (std::size_t i = 0; i < action.target_e7.size(); ++i) {
    const std::int64_t from = next_->machine_e7[i], way = action.target_e7[i] - from;
    action.target_e7[i] = from + way * std::int64_t{returned} / std::int64_t{plan_.pieces};
  }
  return true;
}

/// The last decimal that the program writes. Trailing zeros are often left out, so the most
/// decimals so far count, and at least 0.01 mm or 1/1000 inch.
std::uint8_t Interpreter::digit_um(const Modal& modal) {
  const bool is_coarse = modal.decimals <= (modal.inches ? 3 : 2);
  if (modal.inches) return is_coarse ? 25 : modal.decimals == 4 ? 3 : 1;
  return is_coarse ? 10 : 1;
}

[[gnu::hot]] bool Interpreter::give_move(Stage stage, Action& action) {
  if (stage == Stage::move && plan_.pieces != 0) return give_piece(action);
  fill_move(action, stage != Stage::move || plan_.motion == Motion::rapid);
  if (stage == Stage::via)
    action.target_e7 = state_->rotations().turned(plan_.points[0]);
  else
    action.target_e7 = state_->machine_e7;
  action.programmed_end = stage != Stage::via;
  if (stage == Stage::move && is_probe(plan_.motion)) {
    action.kind = ActionKind::probe;
    action.probe_away = plan_.motion >= Motion::probe_away;
    action.probe_must = plan_.motion == Motion::probe_toward || plan_.motion == Motion::probe_away;
  }
  if (stage == Stage::move && plan_.motion == Motion::line && !plan_.jog)
    action.digit_um = digit_um(state_->modal);
  done(stage);
  return true;
}

bool Interpreter::give_curve(Action& action) {
  Place end;
  if (!curve_.next(end)) {
    done(Stage::curve);
    return false;
  }
  fill_move(action, false);
  if (action.timed) action.time_us = share_.next(end);
  if (plan_.is_rotary_arc())
    action.feed_um_min = feed_of_all_axes(plan_.feed_um_min, share_.step_to(end), end, false);
  if (!curve_.active()) done(Stage::curve);
  action.programmed_end = !plan_.has(Stage::curve);
  action.target_e7 = action.programmed_end ? state_->machine_e7 : state_->rotations().turned(end);
  return true;
}

bool Interpreter::give_cycle(Action& action) {
  CycleMove move;
  if (!work_.cycle.next(move)) {
    done(Stage::cycle);
    return false;
  }
  switch (move.kind) {
    case CycleMove::Kind::dwell:
      begin_action(action, ActionKind::dwell);
      action.rapid = true;
      action.time_us = plan_.dwell_us;
      return true;
    case CycleMove::Kind::spindle_off:
    case CycleMove::Kind::spindle_on:
      begin_action(action, ActionKind::spindle);
      action.rapid = true;
      if (move.kind == CycleMove::Kind::spindle_off) action.spindle = Spindle::off;
      return true;
    default:
      break;
  }
  fill_move(action, move.kind == CycleMove::Kind::rapid);
  action.target_e7 = state_->rotations().turned(move.to);
  action.programmed_end = move.bottom || action.rapid;
  return true;
}

bool Interpreter::give_stop(Action& action) {
  const bool end = plan_.stop == 2 || plan_.stop == 30;
  done(Stage::stop);
  if (end) end_program();
  begin_action(action, end ? ActionKind::program_end : ActionKind::pause);
  return true;
}

}  // namespace lamplock::program
