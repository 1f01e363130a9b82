// Cutter compensation in the interpreter: lines become moves that wait, corners, and actions that
// wait with them (compensation.hpp).
#include <bit>
#include <new>

#include "firmware/program/interpreter.hpp"

namespace lamplock::program {

// --- lines ------------------------------------------------------------------------------------

/// The rest of run() for a statement that begins, has or ends compensation, or follows it.
Fault Interpreter::run_users(Statement& statement, Fault fault) {
  if (!fault) fault = statement.check_users();
  if (fault)
    plan_.stages = 0;
  else
    take_over(statement);
  if (expressions_.has_assignments()) expressions_.end_line(!fault);
  return fault;
}

Fault Interpreter::run_compensated(Statement& statement, std::string_view line, Fault fault) {
  if (users_lines_) return run_users(statement, fault);
  if (!fault) fault = check_compensated(statement, line);
  if (!fault) {
    take_over(statement);
    collect_between();
    if (beside_.active && plan_.has(Stage::move)) {
      done(Stage::move);
      plan_.add(Stage::corner);
    }
    in_compensation_ = beside_.active || state_->modal.cutter != Cutter::off;
  }
  if (expressions_.has_assignments()) expressions_.end_line(!fault);
  return fault;
}

Fault Interpreter::check_compensated(Statement& statement, std::string_view line) {
  Fault fault;
  const bool was_beside = beside_.active;
  if (was_beside) fault = leave_beside(statement, line);
  if (!fault && (state_->modal.cutter != Cutter::off || next_->modal.cutter != Cutter::off)) {
    fault = statement.check_compensated(state_->modal);
    if (!fault) fault = compensate(statement);
  }
  if (fault) {
    plan_.stages = 0;
    if (was_beside && !beside_.active) go_beside();
  }
  return fault;
}

Fault Interpreter::compensate(const Statement& statement) {
  const GcodeError error = compensate_line(statement);
  return error == GcodeError::none ? Fault{} : Fault{error, statement.compensation_column()};
}

GcodeError Interpreter::compensate_line(const Statement& statement) {
  if (state_->modal.cutter == Cutter::off) {
    const PlaneAxes axes = axes_of(next_->modal.plane);
    Compensation* const begun = new (&work_.compensation) Compensation;
    begun->begin(statement.cutter_radius_e7(), next_->modal.cutter == Cutter::left,
                 {axes.first, axes.second, axes.normal});
  }
  Compensation& work = work_.compensation;
  if (work.offset().radius_e7() == 0) return GcodeError::none;
  held_step_ = 0;
  curve_.stop();
  if (next_->modal.cutter == Cutter::off || plan_.has(Stage::stop))
    return end_compensation(statement);
  if (moves_in_plane()) return compensate_move();
  if (same_place(state_->programmed_e7, next_->programmed_e7)) done(Stage::move);
  if (!work.holds()) return GcodeError::none;
  const auto actions = static_cast<std::uint32_t>(std::popcount(plan_.stages));
  return work.between_count() + actions <= Compensation::max_between ? GcodeError::none
                                                                     : GcodeError::too_many_between;
}

bool Interpreter::moves_in_plane() const {
  if (plan_.has(Stage::curve)) return true;
  if (!plan_.has(Stage::move)) return false;
  const CurvePlane& plane = work_.compensation.plane();
  const Place &from = state_->programmed_e7, &to = next_->programmed_e7;
  return from[plane.first] != to[plane.first] || from[plane.second] != to[plane.second];
}

PlaneBlock Interpreter::plane_block(const State& from, const State& to) const {
  const Compensation& work = work_.compensation;
  const bool arc = is_arc(plan_.motion);
  return {work.in_plane(from.programmed_e7), work.in_plane(to.programmed_e7),
          arc ? work.in_plane(plan_.points[0]) : PlanePoint{}, arc,
          plan_.motion == Motion::arc_clockwise};
}

/// The move of the line waits; the one before is released.
GcodeError Interpreter::compensate_move() {
  Compensation& work = work_.compensation;
  const PlaneBlock block = plane_block(*state_, *next_);
  if (!work.holds()) {
    if (block.arc || !work.enter(block)) return GcodeError::bad_entry;
  } else {
    if (!work.join(block)) return GcodeError::cutter_too_large;
    plan_.add(Stage::held);
  }
  done(Stage::move);
  done(Stage::curve);
  plan_.add(Stage::corner);
  return GcodeError::none;
}

/// G40, M2, M30: the move that waits ends beside its programmed end.
GcodeError Interpreter::end_compensation(const Statement& statement) {
  Compensation& work = work_.compensation;
  if (!work.holds()) return GcodeError::none;
  if (plan_.has(Stage::curve)) return GcodeError::bad_entry;
  if (!work.finish()) return GcodeError::cutter_too_large;
  plan_.add(Stage::held);
  if (plan_.has(Stage::move) && statement.names_plane_axes()) return GcodeError::none;
  const PlanePoint end = work.held().end, programmed = work.in_plane(next_->programmed_e7);
  beside_ = {{end.first_e7 - programmed.first_e7, end.second_e7 - programmed.second_e7},
             work.plane().first,
             work.plane().second,
             true};
  return GcodeError::none;
}

/// The actions of a line that does not move in the plane wait after the move.
void Interpreter::collect_between() {
  if (!holds_move() || plan_.has(Stage::held) || plan_.has(Stage::corner)) return;
  while (plan_.stages != 0) {
    Action& action = work_.compensation.add_between();
    give(static_cast<Stage>(std::countr_zero(plan_.stages)), action);
    action.target_e7 = state_->programmed_e7;
  }
}

// --- actions ----------------------------------------------------------------------------------

/// The state before the line is still there, and has the rotation of the move.
bool Interpreter::give_held(Action& action) {
  Compensation& work = work_.compensation;
  const Rotations rotations = next_->rotations();
  if (held_step_ == 0) {
    action = work.held().action;
    Place end = work.held_end();
    if (work.is_curve()) {
      if (!curve_.active()) curve_.begin_arc(work.held_arc(options_.arc_tolerance_e7));
      curve_.next(end);
    }
    action.target_e7 = rotations.turned(end);
    action.programmed_end = !curve_.active();
    if (curve_.active()) return true;
  } else {
    action = work.between(held_step_ - 1u);
    action.target_e7 = rotations.turned(work.put(action.target_e7, work.held().end));
  }
  if (held_step_++ == work.between_count()) {
    held_step_ = 0;
    work.release();
    done(Stage::held);
  }
  return true;
}

/// The arc round the corner; then the move of the line waits. After G40 a move along another axis.
bool Interpreter::give_corner(Action& action) {
  if (beside_.active) {
    done(Stage::corner);
    give_move(Stage::move, action);
    action.target_e7 = beside();
    return true;
  }
  Compensation& work = work_.compensation;
  if (!work.has_corner()) {
    hold_move();
    return false;
  }
  if (!curve_.active())
    curve_.begin_arc(work.corner_arc(next_->programmed_e7, options_.arc_tolerance_e7));
  Place end;
  curve_.next(end);
  fill_move(action, plan_.motion == Motion::rapid);
  action.target_e7 = state_->rotations().turned(end);
  action.programmed_end = !curve_.active();
  action.exact_stop = false;
  if (action.programmed_end) work.end_corner();
  return true;
}

void Interpreter::hold_move() {
  done(Stage::corner);
  const PlaneBlock block = plane_block(*next_, *state_);
  Compensation::Held& held = work_.compensation.hold();
  fill_move(held.action, plan_.motion == Motion::rapid);
  if (plan_.motion == Motion::line) held.action.digit_um = digit_um(state_->modal);
  held.action.target_e7 = state_->programmed_e7;
  held.start_e7 = next_->programmed_e7;
  held.centre = block.centre;
  held.arc = block.arc;
  held.clockwise = block.clockwise;
}

Extent Interpreter::compensated_extent() const {
  const Compensation& work = work_.compensation;
  const Rotations rotations = next_->rotations();
  const auto add = [](Extent& all, const Extent& part) {
    all.add(part.low());
    all.add(part.high());
  };
  Extent extent(rotations.turned(work.held_end()));
  if (work.is_curve()) add(extent, extent_of(work.held_arc(1), rotations));
  for (std::uint32_t i = 0; i < work.between_count(); ++i)
    extent.add(rotations.turned(work.put(work.between(i).target_e7, work.held().end)));
  if (plan_.has(Stage::corner) && work.has_corner())
    add(extent, extent_of(work.corner_arc(next_->programmed_e7, 1), rotations));
  return extent;
}

// --- after compensation -----------------------------------------------------------------------

/// Where the machine is beside the programmed place.
Place Interpreter::beside() const {
  Place place = state_->programmed_e7;
  place[beside_.first] += beside_.distance_e7.first_e7;
  place[beside_.second] += beside_.distance_e7.second_e7;
  return state_->rotations().turned(place);
}

/// The program continues from where the machine is.
void Interpreter::settle() {
  Place& place = state_->programmed_e7;
  place[beside_.first] += beside_.distance_e7.first_e7;
  place[beside_.second] += beside_.distance_e7.second_e7;
  state_->machine_e7 = state_->rotations().turned(place);
  beside_.active = false;
}

/// The opposite.
void Interpreter::go_beside() {
  Place& place = state_->programmed_e7;
  place[beside_.first] -= beside_.distance_e7.first_e7;
  place[beside_.second] -= beside_.distance_e7.second_e7;
  state_->machine_e7 = state_->rotations().turned(place);
  beside_.active = true;
}

/// The line moves in no way that depends on where exactly the machine is.
bool Interpreter::stays_beside(const Statement& statement) const {
  constexpr std::uint32_t simple =
      1u << static_cast<int>(Stage::move) | 1u << static_cast<int>(Stage::stop);
  constexpr std::uint32_t first_move = static_cast<std::uint32_t>(Stage::via);
  const std::uint32_t moves = plan_.stages >> first_move << first_move;
  const bool turns = !(next_->modal.rotation == state_->modal.rotation &&
                       next_->system_rotation == state_->system_rotation);
  return (moves & ~simple) == 0 && !is_probe(plan_.motion) && plan_.pieces == 0 &&
         plan_.weights_e6[0] == 0 && !statement.needs_machine_place() && !turns;
}

/// A line after G40. The first move in the plane leads from beside the contour to its programmed
/// end; moves along the other axes stay beside the contour. All else begins where the machine is,
/// and is checked again.
Fault Interpreter::leave_beside(Statement& statement, std::string_view line) {
  if (plan_.has(Stage::curve)) return {GcodeError::bad_entry, statement.compensation_column()};
  if (stays_beside(statement)) {
    if (plan_.has(Stage::move) && statement.names_plane_axes()) beside_.active = false;
    return {};
  }
  if (expressions_.has_assignments()) expressions_.end_line(false);
  settle();
  new (&statement) Statement(options_, parameters_, saved_, expressions_, *state_, *next_, plan_);
  return statement.check(line);
}

}  // namespace lamplock::program
