#include "firmware/motion/line/planner.hpp"

namespace lamplock::motion {
namespace {

/// Chords (line/chords.hpp), in roundings: where a corner of tiny lines differs from rounding,
/// where a curve worth slowing for does, and where rounding does not matter.
constexpr std::uint32_t short_chord = 12;
constexpr std::uint32_t long_chord = 128;
constexpr std::uint32_t gentle_chord = 512;

constexpr std::uint32_t max_feed_percent = 200, min_feed_percent = 10;
constexpr std::uint32_t full_percent = 100;

/// Lines whose mean length counts for the pace, and those whose mean cost does: where lines are
/// joined, one of 16 costs more, which must not change the pace.
constexpr int paced_lines_log2 = 3, counted_lines_log2 = 6;
/// The pace of lines is constant until it could be a 2^n-th higher, or should be one lower.
constexpr int pace_rise_log2 = 4, pace_fall_log2 = 6;

UFloat part(std::uint32_t percent) { return UFloat(percent) / UFloat(full_percent); }

std::uint32_t within(std::uint32_t value, std::uint32_t low, std::uint32_t high) {
  return value < low ? low : value > high ? high : value;
}

bool is_before(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(a - b) < 0; }

}  // namespace

LinePlanner::LinePlanner(LineRing& ring, const LineLimits& limits, const Limits& axes)
    : ring_(ring),
      limits_(limits),
      axes_(axes),
      short_chords_(short_chord, LineBends::any),
      long_chords_(long_chord, LineBends::any),
      gentle_chords_(gentle_chord, LineBends::gentle) {
  forget();
}

void LinePlanner::start(const stepper::MotionState& at) {
  at_ = at;
  held_ = cancelled_ = false;
  forget();
}

/// Drops all lines, at rest.
void LinePlanner::forget() {
  ring_.clear();
  lookahead_.reset();
  begun_ = stop_ = settles_ = returns_ = open_ = clear_ = false;
  ++forgets_;
  speed_ = {};
  last_ = {};
  recent_ = pace_ = {};
  end_ = place_of(at_);
  beam_.forget();
  reset_chords();
}

void LinePlanner::reset_chords() {
  for (LineChords* chords : {&short_chords_, &long_chords_, &gentle_chords_})
    chords->reset(end_, ring_.end(), limits_);
}

void LinePlanner::set_feed_percent(std::uint32_t percent) {
  factor_.feed = part(within(percent, min_feed_percent, max_feed_percent));
  factor_.plain = percent == full_percent;
  lookahead_.reset();
}

void LinePlanner::set_rapid_percent(std::uint32_t percent) {
  factor_.rapid = part(within(percent, 1, full_percent));
  lookahead_.reset();
}

bool LinePlanner::push(const LineTarget& target) {
  if (ring_.full()) return false;
  const WayParts way = way_between(end_, target);
  const UFloat length = length_of(way, limits_);
  if (is_zero(length)) {
    stop_ = stop_ || target.exact_stop;
    return true;
  }
  const bool paced = limits_.line_ticks != 0;
  const UFloat pace = paced ? paced_speed(length) : UFloat();
  const bool joined = join(target, pace);
  if (paced) count_line(joined);
  if (!joined) {
    close_line();
    before_ = last_;
    joint_stops_ = stop_;
    join_.start(end_, way, limits_);
    put(target, make_shape(way, limits_), pace);
    ring_.push();
    open_ = true;
  }
  end_ = target;
  stop_ = target.exact_stop;
  return true;
}

/// Fills the place after the last line, or the last one again; it begins at the end of `before_`.
void LinePlanner::put(const LineTarget& target, const LineShape& shape, UFloat pace) {
  const bool has_time = target.time_us != 0;
  const UFloat speed_for_time =
      has_time ? shape.length / (UFloat(target.time_us) * UFloat(ticks_per_second / 1'000'000))
               : UFloat();
  LineBounds bounds = make_bounds(shape, limits_);
  if (!is_zero(pace)) bounds.speed = least(bounds.speed, pace);
  if (has_time && !target.timed) bounds.speed = least(bounds.speed, speed_for_time);
  Line& line = ring_.next();
  line.set_place(target);
  line.set_length(shape.length);
  line.accel = LinePacked(bounds.accel);
  line.speed = LinePacked(bounds.speed);
  line.line = target.line & 0xffffffu;
  line.changes = target.changes;
  line.power = target.power;
  line.laser = target.rapid ? LinePower::off : target.laser;
  line.rapid = target.rapid;
  line.pixels = target.pixels && line.laser != LinePower::off;
  line.pulses = target.pulses && line.laser != LinePower::off;
  line.timed = target.timed && has_time;
  feed_um_min_ = target.feed_um_min;
  UFloat feed = line.timed ? speed_for_time : UFloat(target.feed_um_min) * limits_.um_min;
  // M4 scales its power by the programmed feed, whatever limits the speed.
  if (is_zero(feed)) feed = bounds.speed;
  line.feed = LinePacked(feed);
  const LineCorner corner = corner_at_end(line, shape);
  line.corner_2 = LinePacked(corner.speed_2);
  clear_ = corner.clear;
  line.entry_2 = {};
  last_ = shape;
}

/// Whether the target is more of the last line: nothing but its place and its number differ.
/// Numbers are for reports: a program with them takes the same time as without.
bool LinePlanner::continues(const LineTarget& target) const {
  // The corner at the start of the last line may change: the machine must be far from it.
  if (!open_ || stop_ || ring_.size() < 3 || target.changes != 0) return false;
  if (target.digit_um == 0 || target.timed || target.pixels || target.pulses) return false;
  const Line& line = ring_.at(ring_.end() - 1);
  if (line.timed || line.pixels || line.pulses) return false;
  const LinePower laser = target.rapid ? LinePower::off : target.laser;
  return line.rapid == target.rapid && line.laser == laser && line.power == target.power &&
         feed_um_min_ == target.feed_um_min;
}

/// Extends the last line to the target; false if that is a line of its own.
bool LinePlanner::join(const LineTarget& target, UFloat pace) {
  if (!continues(target)) return false;
  const WayParts way = way_between(join_.from(), target);
  const LineShape shape = make_shape(way, limits_);
  if (is_zero(shape.length) || !join_.reaches(way, shape, target.digit_um, limits_)) return false;
  Line& line = ring_.at(ring_.end() - 1);
  const LinePacked entry_2 = line.entry_2;
  const std::uint8_t changes = static_cast<std::uint8_t>(line.changes);
  const std::uint32_t number = line.line;  // the first of those joined is reported
  ring_.unpush();
  join_.extend();
  put(target, shape, pace);
  ring_.push();
  line.changes = changes;
  line.line = number & 0xffffffu;
  line.entry_2 = entry_2;
  lookahead_.extend(ring_, limits_.rise);
  return true;
}

/// The last line is complete: its turn counts. A turn that is clear in itself is a corner, and no
/// bend of the path before and after it.
void LinePlanner::close_line() {
  if (!open_) return;
  open_ = false;
  const std::uint32_t number = ring_.end() - 1;
  LineCap limit;
  for (LineChords* chords : {&short_chords_, &long_chords_, &gentle_chords_}) {
    if (clear_) chords->reset(join_.from(), number, limits_);
    if (chords->add(number, end_, last_, limits_, limit)) cap(limit);
  }
}

/// Maximum speed for lines like the last ones: a short one among long ones costs nothing. It is
/// constant while their length nearly is: a different speed for each of them would divide it into
/// several segments, for which there is no time.
UFloat LinePlanner::paced_speed(UFloat length) {
  constexpr int n = paced_lines_log2;
  if (is_zero(recent_)) {
    recent_ = times_power(length, n);
    recent_ticks_ = limits_.line_ticks << counted_lines_log2;
  }
  recent_ = difference(recent_, times_power(recent_, -n)) + length;
  const UFloat now = times_power(recent_, counted_lines_log2 - n) / UFloat(recent_ticks_);
  const bool like_before = difference(now, times_power(now, -pace_rise_log2)) < pace_ &&
                           pace_ < now + times_power(now, -pace_fall_log2);
  if (!like_before) pace_ = now;
  return pace_;
}

/// Joined lines are cheaper: they make no segments.
void LinePlanner::count_line(bool joined) {
  recent_ticks_ -= recent_ticks_ >> counted_lines_log2;
  recent_ticks_ += joined ? limits_.joined_line_ticks : limits_.line_ticks;
}

/// The corner at the start of a line that is next in the ring.
LineCorner LinePlanner::corner_at_end(const Line& line, const LineShape& shape) const {
  if (ring_.empty() || joint_stops_ || is_zero(before_.length)) return {};
  const UFloat slower = least(line.speed.real(), ring_.at(ring_.end() - 1).speed.real());
  LineCorner corner = corner_of(before_, shape, limits_);
  corner.speed_2 = least(slower * slower, corner.speed_2);
  return corner;
}

void LinePlanner::cap(const LineCap& cap) {
  const std::uint32_t open = ring_.begin() + 1;
  const LinePacked speed_2(cap.speed_2);
  for (std::uint32_t i = is_before(cap.first, open) ? open : cap.first; !is_before(cap.last, i);
       ++i) {
    Line& line = ring_.at(i);
    if (!(speed_2 < line.corner_2)) continue;
    line.corner_2 = speed_2;
    if (speed_2 < line.entry_2) lookahead_.reset();
  }
}

void LinePlanner::begin_line() {
  // The end of the program, or a late host: the chords that end there limit lines soon to be run.
  constexpr std::uint32_t max_lines_before_open = 8;
  if (ring_.size() <= max_lines_before_open) close_line();
  const Line& line = ring_.at(ring_.begin());
  way_.target = line;
  if (returns_) way_.target = back_;
  way_.way = way_between(place_of(at_), way_.target);
  dominant_axis_ = 0;
  for (int a = 1; a < max_axes; ++a)
    if (abs64(way_.way.parts[index(a)]) > abs64(way_.way.parts[index(dominant_axis_)]))
      dominant_axis_ = a;
  length_ = returns_ ? make_shape(way_.way, limits_).length : line.length();
  // The length is 0 if the machine rests at the end of the line since return_to().
  way_.per_length = is_zero(length_) ? UFloat() : UFloat::power(-way_.way.bits) / length_;
  begun_ = whole_ = true;
  if (returns_) return;
  // From feed rate and length, because the time itself is not stored.
  time_left_ = line.timed ? length_ / line.feed.real() : UFloat();
  beam_.begin(line, length_, way_, dominant_axis_);
}

UFloat LinePlanner::task_speed(const Line& line, const LineTask& task) const {
  if (!line.timed) return nominal_speed(line, factor_);
  LineTask fastest = task;
  fastest.speed = line.speed.real();
  return speed_for_time(fastest, time_left_ / factor_.feed);
}

LineTask LinePlanner::task() {
  LineTask task;
  task.length = whole_ ? length_ : length_left(way_, length_, dominant_axis_, at_);
  task.start = speed_;
  task.rise = &limits_.rise;
  task.stop = held_;
  task.slice_ticks = limits_.rise.none() ? steady_slice_ticks : line_slice_ticks;
  if (returns_) {
    const LineBounds bounds = make_bounds(make_shape(way_.way, limits_), limits_);
    task.accel = bounds.accel;
    task.speed = bounds.speed * factor_.rapid;
    return task;
  }
  const Line& line = ring_.at(ring_.begin());
  task.end = square_root(lookahead_.exit_speed_2(ring_, factor_, limits_.rise));
  task.accel = line.accel.real();
  task.speed = task_speed(line, task);
  return task;
}

bool LinePlanner::next(LineSegment& out) {
  if (settles_ && !held_ && settle(out)) return true;
  if (ring_.empty() || (held_ && at_rest())) return end_cancel(out);
  if (!begun_) begin_line();
  const LineTask todo = task();
  const LineRun run = make_run(todo);
  if (returns_) out = {};
  make_segment(at_, way_, run, axes_, !limits_.rise.none(), out.segment);
  out.settles = returns_;
  const Line& line = ring_.at(ring_.begin());
  out.line = out.segment.point = line.line;
  if (!returns_) write(line, todo, run, out);
  at_ = out.segment.end;
  advance(run);
  return true;
}

/// Copies the line's data to a segment of it.
void LinePlanner::write(const Line& line, const LineTask& task, const LineRun& run,
                        LineSegment& out) {
  out.segment.ends_point = run.whole;
  out.segment.changes = static_cast<std::uint8_t>(line.changes);
  out.ends_line = run.whole;
  out.rapid = line.rapid;
  out.power_start = power(line, run.start);
  out.power_cruise = power(line, run.cruise);
  out.power_end = power(line, run.end);
  beam_.write(line, task.length, out.segment);
}

void LinePlanner::advance(const LineRun& run) {
  speed_ = run.next;
  whole_ = false;
  if (!is_zero(time_left_)) time_left_ = difference(time_left_, UFloat(run.ticks()) * factor_.feed);
  if (!run.whole) return;
  begun_ = false;
  if (returns_) {
    returns_ = false;
    return;
  }
  beam_.end(ring_.at(ring_.begin()));
  ring_.pop();
}

/// At rest after cancel(): moves to the middle of the step, then drops all lines.
bool LinePlanner::end_cancel(LineSegment& out) {
  if (!cancelled_ || !at_rest()) return false;
  held_ = cancelled_ = false;
  const bool settles = settle(out);
  forget();
  return settles;
}

std::uint16_t LinePlanner::power(const Line& line, UFloat speed) const {
  if (line.laser == LinePower::off || line.pixels || line.pulses) return 0;
  if (line.laser == LinePower::constant) return line.power;
  const UFloat power = speed * UFloat(line.power) / line.feed.real();
  return static_cast<std::uint16_t>(whole_down(power + UFloat(1u, -1), full_power));
}

}  // namespace lamplock::motion
