// LinePlanner, the return to a mark: the lines as they were there, and the way to it from where the
// machine rests; and the move to the middle of a step that begins it, or ends a cancel.
#include "firmware/motion/line/planner.hpp"

namespace lamplock::motion {
namespace {

/// Ticks of half of a motion of half a step: minimum, and maximum of half a minute.
constexpr std::uint32_t min_settling_ticks = 32;
constexpr std::uint32_t max_settling_ticks = 30 * ticks_per_second;

/// Moves a place off the edges of its step: the machine reverses there.
void keep_in_step(LinePlace& place) {
  for (std::int8_t& off : place.off_q8)
    off = static_cast<std::int8_t>(off < -max_off_q8  ? -max_off_q8
                                   : off > max_off_q8 ? max_off_q8
                                                      : off);
  keep_in_motor_steps(place);
}

}  // namespace

/// Rest to rest over w takes 2 sqrt(w/A).
std::uint32_t LinePlanner::settling_ticks() const {
  UFloat longest;
  for (int a = 0; a < limits_.axes; ++a) {
    const LineAxis& axis = limits_.axis[index(a)];
    const std::uint64_t at = at_.axis[index(a)].position_q64.lo();
    const std::uint64_t off = at < half_step_q64 ? half_step_q64 - at : at - half_step_q64;
    if (off >> 44 == 0) continue;  // 1e-6 step
    longest = most(longest, UFloat(off, -64) * axis.unit / axis.accel);
  }
  if (is_zero(longest)) return 0;
  // With at most the acceleration that the jerk reaches at once.
  if (!limits_.rise.none()) longest = longest / limits_.rise.flat_share;
  // Two equal phases.
  const std::uint32_t half = whole_up(square_root(longest), max_settling_ticks - 1) + 1;
  return 2 * (half < min_settling_ticks ? min_settling_ticks : half);
}

/// At rest: moves to the middle of the step; false if the machine is there.
bool LinePlanner::settle(LineSegment& out) {
  settles_ = false;
  const std::uint32_t ticks = settling_ticks();
  if (ticks == 0) return false;
  out = {};
  out.settles = true;
  out.segment = make_settling(at_, ticks);
  at_ = out.segment.end;
  return true;
}

LinePlanner::Mark LinePlanner::mark() const {
  const UFloat length = ring_.empty() ? UFloat() : ring_.at(ring_.begin()).length();
  return {ring_.begin(), forgets_, length, settles_ || returns_ ? back_ : place_of(at_),
          beam_.place()};
}

void LinePlanner::return_to(const Mark& mark, const stepper::MotionState& at_rest) {
  at_ = at_rest;
  speed_ = {};
  begun_ = returns_ = false;
  settles_ = true;
  // Where the machine settles.
  back_ = place_of(at_);
  back_.off_q8 = {};
  // A cancel that was complete before remains so.
  if (mark.forgets == forgets_) {
    ring_.return_to(mark.begin);
    LinePlace place = mark.place;
    if (ring_.empty()) {
      settles_ = false;  // it rested there and still does
    } else {
      beam_.return_to(mark.beam, ring_.at(ring_.begin()), mark.length);
      keep_in_step(place);
      returns_ = !is_zero(make_shape(way_between(back_, place), limits_).length);
    }
    back_ = place;
  }
  lookahead_.reset();
  measure_again();
}

/// The first line starts elsewhere, at the middle of a step: measures its length, its limits, and
/// the corner at its end.
void LinePlanner::measure_again() {
  if (ring_.empty()) {
    end_ = back_;
    last_ = {};
    open_ = false;
    reset_chords();
    return;
  }
  Line& line = ring_.at(ring_.begin());
  const LineShape shape = make_shape(way_between(back_, line), limits_);
  line.set_length(shape.length);
  if (!is_zero(shape.length)) {
    LineBounds bounds = make_bounds(shape, limits_);
    if (line.pixels) bounds.speed = least(bounds.speed, line.speed.real());
    line.accel = LinePacked(bounds.accel);
    line.speed = LinePacked(bounds.speed);
  }
  if (ring_.size() == 1) {
    last_ = shape;
    return;
  }
  Line& second = ring_.at(ring_.begin() + 1);
  UFloat corner_speed_2;
  if (!is_zero(shape.length)) {
    const LineShape after = make_shape(way_between(line, second), limits_);
    const UFloat slower = least(line.speed.real(), second.speed.real());
    corner_speed_2 = least(slower * slower, corner_of(shape, after, limits_).speed_2);
  }
  const LinePacked corner_2(corner_speed_2);
  if (corner_2 < second.corner_2) second.corner_2 = corner_2;
}

}  // namespace lamplock::motion
