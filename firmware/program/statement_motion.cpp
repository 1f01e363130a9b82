// Motion of a statement: targets, arcs, splines, cycles, homes.
#include "firmware/program/curves/curve.hpp"
#include "firmware/program/statement.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::program {
namespace {

CurvePlane curve_plane(Plane plane) {
  const PlaneAxes axes = axes_of(plane);
  return {axes.first, axes.second, axes.normal};
}

/// Letters of distances to a centre, by axis.
constexpr std::string_view centre_letters = "IJK";

/// 2/3 of a distance, to the nearest.
constexpr std::int64_t two_thirds(std::int64_t e7) { return (2 * e7 + (e7 < 0 ? -1 : 1)) / 3; }

}  // namespace

// --- ends -------------------------------------------------------------------------------------

/// Column for errors of the motion as a whole.
std::uint16_t Statement::motion_column() const {
  if (block_.has(Group::motion)) return block_.column(Group::motion);
  return block_.axes() != 0 ? block_.axis_column(block_.axes()) : centre_column();
}

/// Column of the first word of a centre; the line has one.
std::uint16_t Statement::centre_column() const {
  std::uint16_t column = 0;
  for (const char letter : centre_letters)
    if (block_.has(letter) && (column == 0 || block_.word(letter).column < column))
      column = block_.word(letter).column;
  return column;
}

bool Statement::fail_motion(GcodeError error) { return fail(error, motion_column()); }

bool Statement::needed(char letter) { return needed(letter, motion_column()); }

/// Target of the axis words.
[[gnu::hot]] bool Statement::target(Place& place, bool in_machine) {
  place = in_machine ? after_.machine_e7 : after_.programmed_e7;
  for (int i = 0; i < options_.axes; ++i) {
    if ((block_.axes() >> i & 1u) == 0) continue;
    std::int64_t& value = place[index(i)];
    const std::int64_t word = axis_e7(i);
    const std::uint8_t decimals = block_.axis(i).decimals;
    if (decimals > after_.modal.decimals) after_.modal.decimals = decimals;
    value = in_machine ? word : word + (after_.modal.relative ? value : offset_e7(i));
    if (!inside(value, max_position_e7, GcodeError::bad_target, block_.axis(i).column))
      return false;
  }
  block_.take_axes();
  if ((block_.axes() & options_.rotary) != 0) [[unlikely]]
    return rotary_target(place, in_machine);
  return true;
}

/// Ends the line at a programmed place; checks that each axis is inside the range.
[[gnu::hot]] bool Statement::end_at(const Place& programmed) {
  after_.programmed_e7 = programmed;
  after_.cycle.series = false;
  after_.spline.known = false;
  if (after_.rotations().active()) [[unlikely]]
    return end_turned();
  after_.machine_e7 = programmed;
  return true;
}

bool Statement::end_turned() {
  after_.machine_e7 = after_.rotations().turned(after_.programmed_e7);
  return all_inside(after_.machine_e7, motion_column());
}

bool Statement::all_inside(const Place& place, std::uint16_t column) {
  for (const std::int64_t e7 : place)
    if (!inside(e7, max_position_e7, GcodeError::bad_target, column)) return false;
  return true;
}

/// Ends the line at a place in machine coordinates, inside the range.
bool Statement::end_at_machine(const Place& machine) {
  end_at(after_.rotations().turned_back(machine));
  fault_ = {};  // a home at the edge may be rounded out of the range
  after_.machine_e7 = machine;
  return true;
}

bool Statement::at_home() {
  const bool g28 = block_.code(Group::once) == 280;
  const Place& home = g28 ? parameters_.home_g28_e7 : parameters_.home_g30_e7;
  const std::uint32_t axes = block_.axes();
  Place end = after_.machine_e7;
  if (axes != 0) {
    if (!target(plan_.points[0], false)) return false;
    plan_.add(Stage::via);
    end = after_.rotations().turned(plan_.points[0]);
    if (!all_inside(end, block_.axis_column(axes))) return false;
  }
  for (int i = 0; i < options_.axes; ++i)
    if (axes == 0 || (axes >> i & 1u) != 0) end[index(i)] = home_of_axis(i, end, home);
  plan_.add(Stage::home);
  return end_at_machine(end);
}

// --- which motion -----------------------------------------------------------------------------

[[gnu::hot]] bool Statement::motion() {
  const Motion motion = after_.modal.motion;
  const bool machine_move = block_.code(Group::once) == 530;
  if (machine_move && motion != Motion::rapid && motion != Motion::line)
    return fail(GcodeError::machine_move_needs_line, block_.column(Group::once));
  const AxisUse use = block_.axis_use();
  if (use != AxisUse::motion && (use != AxisUse::none || (block_.axes() == 0 && !full_circle())))
    return true;
  if (motion == Motion::none)
    return block_.axes() == 0 || fail_axes(GcodeError::axis_words_unused, block_.axes());
  return motion == Motion::rapid ? move() : cut_move();
}

/// A straight move, if there are axis words.
[[gnu::hot]] bool Statement::move() { return block_.axes() == 0 || straight(); }

/// A move that needs a feed rate.
[[gnu::hot]] bool Statement::cut_move() {
  const Motion motion = after_.modal.motion;
  if (motion == Motion::nurbs) return nurbs();
  if (!feed_in_force()) return false;
  if (motion == Motion::line) return move();
  if (block_.axes() == 0 && !full_circle()) return fail_motion(GcodeError::no_axis_words);
  if (is_arc(motion)) return arc();
  if (motion == Motion::spline) return spline();
  if (motion == Motion::parabola) return parabola();
  return is_cycle(motion) ? drill() : straight();
}

[[gnu::hot]] bool Statement::feed_in_force() {
  const Modal& modal = after_.modal;
  std::uint64_t feed = modal.feed;
  if (modal.feed_mode == FeedMode::inverse_time) {
    feed = plan_.time_us;
  } else if (modal.feed_mode == FeedMode::per_turn) {
    feed = wide_product(modal.feed, modal.speed_milli) / 1'000'000;  // nm and thousandths of a turn
    if (feed >> 32 != 0) return fail_motion(GcodeError::feed_too_high);
  }
  if (feed == 0) return fail_motion(GcodeError::no_feed);
  if (modal.feed_mode != FeedMode::inverse_time)
    plan_.feed_um_min = static_cast<std::uint32_t>(feed);
  return true;
}

[[gnu::hot]] bool Statement::straight() {
  plan_.motion = after_.modal.motion;
  plan_.in_machine = block_.code(Group::once) == 530;
  plan_.add(Stage::move);
  Place place;
  if (!target(place, plan_.in_machine)) return false;
  if (is_probe(plan_.motion) && same_place(place, after_.programmed_e7))
    return fail_motion(GcodeError::bad_target);
  return plan_.in_machine ? end_at_machine(place) : end_at(place);
}

// --- arcs -------------------------------------------------------------------------------------

/// The line has a centre of an arc and no end in its plane: the arc ends where it starts, as in
/// LinuxCNC.
bool Statement::full_circle() const {
  if (!is_arc(after_.modal.motion)) return false;
  const PlaneAxes plane = axes_of(after_.modal.plane);
  const std::uint32_t in_plane = 1u << plane.first | 1u << plane.second;
  return (block_.axes() & in_plane) == 0 &&
         (block_.has(centre_letters[plane.first]) || block_.has(centre_letters[plane.second]));
}

bool Statement::arc() {
  plan_.start = after_.programmed_e7;
  const PlaneAxes plane = axes_of(after_.modal.plane);
  const std::uint32_t in_plane = 1u << plane.first | 1u << plane.second;
  if ((block_.axes() & in_plane) == 0 && !full_circle())
    return fail_axes(GcodeError::no_axis_in_plane, block_.axes());
  plan_.motion = after_.modal.motion;
  plan_.rotary = false;
  plan_.add(Stage::curve);
  Place end;
  if (!target(end, false) || !arc_turns()) return false;
  return (block_.has('R') ? arc_of_radius(end) : arc_of_centre(end)) && end_at(end);
}

bool Statement::arc_turns() {
  plan_.turns = 1;
  if (!block_.has('P')) return true;
  if (!integer('P', plan_.turns)) return false;
  if (plan_.turns == 0) return fail_at('P', GcodeError::not_positive);
  return plan_.turns <= max_repeats || fail_at('P', GcodeError::out_of_range);
}

bool Statement::arc_of_radius(const Place& end) {
  const CurvePlane plane = curve_plane(after_.modal.plane);
  const std::uint16_t column = block_.word('R').column;
  std::int64_t radius = 0;
  if (!length('R', radius)) return false;
  if (plan_.start[plane.first] == end[plane.first] &&
      plan_.start[plane.second] == end[plane.second])
    return fail(GcodeError::bad_target, column);
  const bool clockwise = plan_.motion == Motion::arc_clockwise;
  return centre_of_radius(plan_.start, end, plane, radius, clockwise, plan_.points[0]) ||
         fail(GcodeError::bad_radius, column);
}

bool Statement::arc_of_centre(const Place& end) {
  const CurvePlane plane = curve_plane(after_.modal.plane);
  Place& centre = plan_.points[0];
  centre = plan_.start;
  std::uint16_t column = 0;
  bool complete = true;
  for (const std::uint8_t axis : {plane.first, plane.second}) {
    const char letter = centre_letters[axis];
    if (!block_.has(letter)) {
      complete = false;
      continue;
    }
    std::int64_t e7 = 0;
    if (!length(letter, e7)) return false;
    if (column == 0 || block_.word(letter).column < column) column = block_.word(letter).column;
    centre[axis] = e7 + (after_.modal.centres_absolute ? offset_e7(axis) : plan_.start[axis]);
  }
  if (column == 0 || (after_.modal.centres_absolute && !complete))
    return fail_motion(GcodeError::no_offset_in_plane);
  block_.take(centre_letters[plane.normal]);  // as in grbl: ignored without an error
  const ArcRequest request{plan_.start,
                           end,
                           centre,
                           plane,
                           plan_.motion == Motion::arc_clockwise,
                           plan_.turns,
                           options_.arc_tolerance_e7};
  if (!arc_fits(request)) return fail(GcodeError::bad_target, column);
  // As LinuxCNC: a program with such an arc has lost the centre by rounding or by mistake.
  return arc_has_radius(request) || fail(GcodeError::bad_radius, column);
}

// --- splines ----------------------------------------------------------------------------------

bool Statement::spline() {
  if (!curve_in_xy()) return false;
  plan_.motion = Motion::spline;
  plan_.add(Stage::curve);
  Place end;
  SplineEnd& last = after_.spline;
  if (!spline_start(plan_.points[0]) || !target(end, false)) return false;
  if (!needed('P') || !needed('Q')) return false;
  if (!length('P', last.first_e7) || !length('Q', last.second_e7)) return false;
  plan_.points[1] = end;
  plan_.points[1][0] += last.first_e7;
  plan_.points[1][1] += last.second_e7;
  if (!end_at(end)) return false;
  last.known = true;
  return true;
}

/// The first control point; without I and J the spline continues the previous one.
bool Statement::spline_start(Place& control) {
  control = plan_.start;
  std::int64_t first = -after_.spline.first_e7, second = -after_.spline.second_e7;
  if (block_.has('I') || block_.has('J')) {
    if (!needed('I') || !needed('J')) return false;
    if (!length('I', first) || !length('J', second)) return false;
  } else if (!after_.spline.known) {
    return fail_motion(GcodeError::no_offset_in_plane);
  }
  control[0] += first;
  control[1] += second;
  return true;
}

/// Curves of G5 to G5.3 begin where the program is, in the XY plane.
bool Statement::curve_in_xy() {
  plan_.start = after_.programmed_e7;
  constexpr std::uint32_t xy = 1u << 0 | 1u << 1;
  const std::uint32_t others = block_.axes() & ~xy;
  if (others != 0) return fail_axes(GcodeError::axis_words_unused, others);
  return after_.modal.plane == Plane::xy || fail_motion(GcodeError::unsupported);
}

bool Statement::parabola() {
  if (!curve_in_xy()) return false;
  plan_.motion = Motion::parabola;
  plan_.add(Stage::curve);
  std::array<std::int64_t, 2> control{};
  for (const std::size_t axis : {0u, 1u}) {
    const char letter = centre_letters[axis];
    if (block_.has(letter) && (!length(letter, control[axis]))) return false;
  }
  if (control[0] == 0 && control[1] == 0) return fail_motion(GcodeError::no_offset_in_plane);
  Place end;
  if (!target(end, false)) return false;
  // The same curve as a cubic: its control points are at two thirds of the distance to this one's.
  plan_.points[0] = plan_.start;
  plan_.points[1] = end;
  for (const std::size_t axis : {0u, 1u}) {
    const std::int64_t point = plan_.start[axis] + control[axis];
    plan_.points[0][axis] += two_thirds(control[axis]);
    plan_.points[1][axis] += two_thirds(point - end[axis]);
  }
  return end_at(end);
}

// --- cycles -----------------------------------------------------------------------------------

bool Statement::drill() {
  plan_.start = after_.programmed_e7;
  if (after_.modal.feed_mode == FeedMode::inverse_time) return fail_motion(GcodeError::unsupported);
  plan_.motion = after_.modal.motion;
  plan_.add(Stage::cycle);
  cycle_.normal = axes_of(after_.modal.plane).normal;
  cycle_.kind = plan_.motion;
  cycle_.start = plan_.start;
  cycle_.clearance_e7 = options_.clearance_e7;
  Place first;
  return drill_values() && drill_levels() && target(first, false) && drill_holes(first);
}

/// Words that are kept until the cycle changes.
bool Statement::drill_values() {
  CycleWords& words = after_.cycle;
  const Motion kind = plan_.motion;
  if (block_.has('R')) {
    if (!length('R', words.retract_e7)) return false;
    words.has_retract = true;
  }
  if (has_dwell(kind) && block_.has('P')) {
    if (!seconds('P', words.dwell_us)) return false;
    words.has_dwell = true;
  }
  const bool pecks = kind == Motion::drill_peck || kind == Motion::drill_chip_break;
  if (pecks && block_.has('Q')) {
    if (!length('Q', words.peck_e7)) return false;
    if (words.peck_e7 < 0) return fail_at('Q', GcodeError::negative_value);
    if (words.peck_e7 == 0) return fail_at('Q', GcodeError::not_positive);
    words.has_peck = true;
  }
  const bool complete =
      words.has_retract && (!has_dwell(kind) || words.has_dwell) && (!pecks || words.has_peck);
  if (!complete) return fail_motion(GcodeError::value_missing);
  plan_.dwell_us = words.dwell_us;
  cycle_.peck_e7 = words.peck_e7;
  return true;
}

/// Retract level, depth, and the level at the end.
bool Statement::drill_levels() {
  CycleWords& words = after_.cycle;
  const int normal = cycle_.normal;
  const bool named = (block_.axes() >> normal & 1u) != 0;
  if (named) {
    words.depth_e7 = axis_e7(normal);
    words.has_depth = true;
  }
  if (!words.has_depth) return fail_motion(GcodeError::value_missing);
  const std::int64_t now = plan_.start[index(normal)];
  if (!words.series) words.initial_e7 = now;
  const bool relative = after_.modal.relative;
  const std::int64_t offset = offset_e7(normal);
  cycle_.retract_e7 = words.retract_e7 + (relative ? words.initial_e7 : offset);
  cycle_.depth_e7 = words.depth_e7 + (relative ? cycle_.retract_e7 : offset);
  const std::uint16_t column = named             ? block_.axis(normal).column
                               : block_.has('R') ? block_.word('R').column
                                                 : motion_column();
  if (cycle_.depth_e7 > cycle_.retract_e7) return fail(GcodeError::bad_target, column);
  if (!all_inside({cycle_.depth_e7, cycle_.retract_e7, 0, 0}, column)) return false;
  const bool to_initial = !after_.modal.retract_to_r && words.initial_e7 > cycle_.retract_e7;
  cycle_.end_e7 = to_initial ? words.initial_e7 : cycle_.retract_e7;
  return true;
}

bool Statement::drill_holes(const Place& first) {
  cycle_.holes = 1;
  if (block_.has('L')) {
    if (!integer('L', cycle_.holes)) return false;
    if (cycle_.holes == 0) return fail_at('L', GcodeError::not_positive);
    if (cycle_.holes > max_repeats) return fail_at('L', GcodeError::out_of_range);
  }
  cycle_.first = first;
  Place last = first;
  for (std::size_t i = 0; i < last.size(); ++i) {
    const bool moves = after_.modal.relative && i != cycle_.normal;
    cycle_.step[i] = moves ? first[i] - plan_.start[i] : 0;
    last[i] += cycle_.step[i] * std::int64_t{cycle_.holes - 1};
  }
  last[cycle_.normal] = cycle_.end_e7;
  if (!all_inside(last, motion_column()) || !end_at(last)) return false;
  after_.cycle.series = true;
  return true;
}

}  // namespace lamplock::program
