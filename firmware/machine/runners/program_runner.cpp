#include "firmware/machine/runners/program_runner.hpp"

#include "firmware/machine/runners/program_horizon.hpp"
#include "firmware/motion/profile/pulse.hpp"
#include "firmware/stepper/segment_power.hpp"

namespace lamplock::machine {
namespace {

constexpr std::uint64_t ticks_per_ms = ticks_per_second / 1000;
/// If little is left of the motion handed out, planning is slower than the machine, which may
/// happen where lines are short and costly: the machine slows down a little, and more if that is
/// not enough.
struct PaceStep {
  std::uint64_t left_ticks;  ///< applies below this rest
  std::uint8_t percent;
};
constexpr PaceStep paces[] = {
    {3 * ticks_per_ms, 25}, {5 * ticks_per_ms, 50}, {7 * ticks_per_ms, 80}};
/// With this much ahead the machine runs at full pace again.
constexpr std::uint64_t ahead_ticks = 9 * ticks_per_ms;
constexpr std::uint8_t full_pace = 100;
/// Boards set the length of ticks at most this far ahead.
constexpr std::uint64_t timed_ticks = ticks_per_ms;

}  // namespace

Result ProgramRunner::begin(const settings::Values& values, std::uint32_t tick_q16) {
  planning_.recall();
  planning_.use_lines();
  output_.set_lags(values);
  generator_.settle();
  stepper::MotionState at = generator_.state();
  at.tick = 0;
  const Result result =
      planning_.lines().begin(values, clock_.beat_ticks(), tick_q16, at, generator_.beam().table());
  if (result != Result::ok) return result;
  brake_limits_ = planning_.lines().limits();
  tick_q16_ = tick_q16;
  begun_ = drained_ = stands_ = resting_ = true;
  pace_percent_ = full_pace;
  lost_ = staged_ = broken_off_ = shines_at_rest_ = false;
  brakes_ = 0;
  end_tick_ = offset_ticks_ = 0;
  orders_.held = orders_.cancel = false;
  given_ = orders_;
  lines_ = starvations_ = taken_ = 0;
  return Result::ok;
}

void ProgramRunner::end() {
  planning_.work_exchange().recall();
  begun_ = broken_off_ = false;
  drained_ = true;
  // Lines end beside the middle of steps; the next motion may be of another kind and starts from
  // there.
  if (output_.at_rest()) generator_.settle();
}

bool ProgramRunner::take(const motion::LineTarget& line) {
  LineBuffer& inbox = planning_.lines().inbox();
  if (orders_.cancel || broken_off_ || inbox.full()) return false;
  inbox.push(line);
  // The end of a batch in progress is seen at once.
  if (!planning_.work_exchange().asked()) ++taken_;
  if (line.pulses) pulses_taken_ = true;
  drained_ = stands_ = false;
  return true;
}

void ProgramRunner::set_overrides(std::uint32_t feed_percent, std::uint32_t rapid_percent,
                                  std::uint32_t power_percent) {
  orders_.feed_percent = feed_percent;
  orders_.rapid_percent = rapid_percent;
  power_percent_ = power_percent;
  generator_.beam().set_percent(power_percent);
}

bool ProgramRunner::add_pixels(std::uint16_t power, std::uint32_t count) {
  stepper::PowerTable& table = generator_.beam().table();
  if (table.add(power, count)) return true;
  // Pixels that were not run will not be.
  if (!idle()) return false;
  table.forget();
  return table.add(power, count);
}

void ProgramRunner::end_pixels(motion::LineTarget& line) {
  stepper::PowerTable& table = generator_.beam().table();
  line.power = table.end_list();
  const std::uint32_t min_us = table.min_us();
  if (!line.timed || line.time_us < min_us) line.time_us = min_us;
}

bool ProgramRunner::set_pulses(std::uint32_t milli_per_mm, std::uint32_t length_ns) {
  if (milli_per_mm == orders_.pulses_milli && length_ns == pulse_ns_) return true;
  // Lines that were accepted have other pulses, or a batch begins without these.
  if (!idle() && (pulses_taken_ || !planning_.work_exchange().is_owned())) return false;
  pulses_taken_ = false;
  orders_.pulses_milli = milli_per_mm;
  pulse_ns_ = length_ns;
  const std::uint32_t us = length_ns / 1000;
  generator_.beam().set_pulse(
      clock_.ticks_in(us * clocks_per_us + length_ns % 1000 * clocks_per_us / 1000));
  return true;
}

void ProgramRunner::cancel() {
  // In the light the planner has nothing that it could drop.
  if (shines_at_rest_) return end_light();
  if (begun_ && !idle() && !broken_off_) orders_.cancel = true;
}

void ProgramRunner::abort_move(bool at_contact) {
  if (!begun_ || broken_off_) return;
  planning_.work_exchange().recall();
  brakes_ = 0;
  staged_ = lost_ = stands_ = false;
  resting_ = drained_ = broken_off_ = true;
  orders_.cancel = false;
  brake_at_once(rest_.tick, at_contact);
}

/// Brakes every axis at its limit instead of the motion handed out; not if that motion stops
/// sooner, at `rest_tick`: with little jerk a new brake takes longer than one in progress.
void ProgramRunner::brake_at_once(std::uint64_t rest_tick, bool anywhere) {
  const stepper::MotionState head = generator_.state();
  if (!generator_.running()) {
    segments_.clear();
    end_tick_ = head.tick;
    return;
  }
  const stepper::Segment brake =
      motion::make_brake(head, brake_limits_, generator_.accelerations_q62());
  const bool rests_sooner = rest_tick > head.tick && rest_tick <= brake.end.tick;
  end_tick_ = rests_sooner ? rest_tick : brake.end.tick;
  if (rests_sooner) return;
  segments_.clear();
  const bool inside = anywhere || motion::stays_inside(brake, head, brake_limits_);
  if (!inside && brake_after_segment()) return;
  generator_.replace(brake);
  clock_.set_motion_end(end_tick_);
}

/// Where jerk is limited a brake that begins while an axis speeds up takes it further than planned.
/// Runs the present segment to its end and brakes from there; false if that would leave the work
/// space too.
bool ProgramRunner::brake_after_segment() {
  const stepper::MotionState& end = generator_.segment().end;
  stepper::Segment brake = motion::make_brake(end, brake_limits_);
  if (!end.at_rest() && !motion::stays_inside(brake, end, brake_limits_)) return false;
  end_tick_ = end.tick;
  if (!end.at_rest()) {
    end_tick_ = brake.end.tick;
    segments_.push(brake);
  }
  clock_.set_motion_end(end_tick_);
  return true;
}

void ProgramRunner::run_detour(const stepper::Segment& motion) {
  if (output_.at_rest()) output_.set_leads(clock_);
  stepper::Segment segment = motion;
  segment.start_tick = start_tick();
  segment.end.tick = segment.end_tick();
  clock_.set_min_tick(segment.start_tick, tick_q16_);
  segments_.push(segment);
  end_tick_ = segment.end_tick();
  clock_.set_motion_end(end_tick_);
}

void ProgramRunner::shine_at_rest(std::uint16_t power, std::uint16_t max_power,
                                  std::uint32_t ticks) {
  const std::uint16_t wanted = overridden(power);
  const stepper::Segment light =
      stepper::rest_with_light(generator_.state(), ticks, wanted < max_power ? wanted : max_power);
  if (ticks == 0 || light.power.cruise == 0 || orders_.held) return;
  generator_.limit_power_scale();
  run_detour(light);
  shines_at_rest_ = true;
  light_percent_ = static_cast<std::uint8_t>(power_percent_);
  stands_ = false;
}

void ProgramRunner::end_light() {
  if (!shines_at_rest_) return;
  shines_at_rest_ = stands_ = false;
  abort_detour();
}

/// Power after the override.
std::uint16_t ProgramRunner::overridden(std::uint32_t power) const {
  const std::uint32_t wanted = power * power_percent_ / 100;
  return static_cast<std::uint16_t>(wanted < motion::full_power ? wanted : motion::full_power);
}

void ProgramRunner::abort_detour() { brake_at_once(end_tick_, false); }

bool ProgramRunner::detour_finished() const {
  const bool knows = drained_ || given_.held;
  return knows && !staged_ && planning_.work_exchange().is_owned() && is_still();
}

bool ProgramRunner::wants_batch() const {
  if (broken_off_ || (drained_ && !orders_.cancel)) return false;
  // Held, at rest, and the planner has these commands: another batch would be empty.
  if (resting_ && given_.held && orders_ == given_ && !lost_) return false;
  // Also where motion ends at rest: lines that arrive meanwhile are planned together with the known
  // ones; planned one by one each would be a motion from rest to rest.
  return lost_ || end_tick_ < generator_.head() + horizon_ticks;
}

/// Chooses the pace of the next batch, a factor on the overrides: a late batch would leave the
/// path. In few steps, since each replans all known lines.
void ProgramRunner::choose_pace() {
  const std::uint64_t head = generator_.head();
  const std::uint64_t left = end_tick_ > head ? end_tick_ - head : 0;
  if (resting_ || lost_ || left >= ahead_ticks) {
    pace_percent_ = full_pace;
    return;
  }
  for (const PaceStep& pace : paces) {
    if (left >= pace.left_ticks) continue;
    if (pace.percent < pace_percent_) pace_percent_ = pace.percent;
    return;
  }
}

void ProgramRunner::hand_out() {
  if (lost_) {
    // The machine continues from the end of the brake, in ticks of the planner.
    stepper::MotionState at = rest_;
    at.tick -= offset_ticks_;
    planning_.lines().rejoin(at);
  }
  choose_pace();
  LineOrders paced = orders_;
  paced.feed_percent = orders_.feed_percent * pace_percent_ / full_pace;
  paced.rapid_percent = orders_.rapid_percent * pace_percent_ / full_pace;
  planning_.lines().start(paced);
  given_ = orders_;
  lost_ = staged_ = false;
  planning_.work_exchange().hand_out();
}

/// The brake has begun before the next batch was ready.
void ProgramRunner::miss() {
  brakes_ = 0;
  end_tick_ = rest_.tick;
  resting_ = true;
  lost_ = true;
  ++starvations_;
  staged_ = false;
  planning_.work_exchange().recall();
}

/// Filled ticks are not yet played: 2 ms of them. Their lengths are set earlier.
bool ProgramRunner::is_still() const { return output_.at_rest() && played(end_tick_); }

bool ProgramRunner::is_at_rest() const { return drained_ && is_still(); }

bool ProgramRunner::prepare() {
  if (!begun_) return false;
  if (brake_begun()) miss();
  stands_ = is_at_rest();
  if (stands_) shines_at_rest_ = false;
  // Light at rest has a fixed power: it does not stay brighter than the user has set.
  if (power_percent_ < light_percent_) end_light();
  WorkExchange& work_exchange = planning_.work_exchange();
  if (planning_.may_hand_out() && wants_batch()) hand_out();
  const bool paused = taken_ >= max_taken;
  taken_ = 0;
  return paused || work_exchange.asked();
}

/// Earliest start of a batch from rest.
std::uint64_t ProgramRunner::start_tick() const {
  const std::uint64_t head = generator_.head() + start_margin_ticks;
  const std::uint64_t tick = end_tick_ > head ? end_tick_ : head;
  // At rest the lattice may catch up with the lamp until the next beat.
  if (clock_.mode() != settings::LampMode::slave || !output_.at_rest()) return tick;
  return clock_.tick_of_beat(clock_.beat_at_or_after(tick));
}

void ProgramRunner::write(std::uint32_t i, stepper::Segment& segment) const {
  const motion::LineSegment& made = planning_.lines().segment(i);
  segment = made.segment;
  segment.start_tick += offset_ticks_;
  segment.end.tick += offset_ticks_;
  segment.ends_point = false;  // only used in jobs
  if (segment.shines && segment.beam_kind != stepper::BeamKind::pulses) return;
  if (segment.shines) {
    segment.beam.power = overridden(segment.beam.power);
    return;
  }
  stepper::set_power(segment, {overridden(made.power_start), overridden(made.power_cruise),
                               overridden(made.power_end)});
}

/// All of it or nothing: a lost batch can be planned again only from its start.
bool ProgramRunner::batch_fits() const {
  return segments_.free() + brakes_ > planning_.lines().count();
}

void ProgramRunner::stage() {
  if (!begun_ || staged_ || !planning_.work_exchange().complete()) return;
  const LineWork& work = planning_.lines();
  const std::uint32_t count = work.count();
  if (count == 0) return finish_batch();
  if (!batch_fits()) return;
  if (resting_) offset_ticks_ = start_tick() - work.segment(0).segment.start_tick;
  // The first one may replace a brake, which may still begin.
  for (std::uint32_t i = 1; i < count; ++i) write(i, segments_.stage(i - brakes_));
  if (!work.ends_at_rest()) {
    stepper::MotionState end = work.segment(count - 1).segment.end;
    end.tick += offset_ticks_;
    segments_.stage(count - brakes_) = motion::make_brake(end, brake_limits_);
  }
  staged_ = true;
}

void ProgramRunner::finish_batch() {
  LineWork& work = planning_.lines();
  work.accept();
  drained_ = work.drained();
  lines_ = work.lines();
  resting_ = work.ends_at_rest();
  if (given_.cancel && drained_) orders_.cancel = orders_.held = false;
  planning_.work_exchange().recall();
  staged_ = false;
}

bool ProgramRunner::commit() {
  if (!begun_ || !staged_ || brake_begun()) return false;
  const LineWork& work = planning_.lines();
  const std::uint32_t count = work.count();
  const std::uint64_t start = work.segment(0).segment.start_tick + offset_ticks_;
  if (output_.at_rest()) output_.set_leads(clock_);
  if (resting_ && start < generator_.head()) {
    staged_ = false;  // will be staged again
    return false;
  }
  if (resting_) clock_.set_min_tick(start, tick_q16_);
  segments_.take_back(brakes_);
  write(0, segments_.stage());
  const bool ends = work.ends_at_rest();
  brakes_ = ends ? 0 : 1;
  for (std::uint32_t i = 0; i < count + brakes_; ++i) segments_.publish();
  const std::uint32_t last = segments_.begun() + segments_.size() - 1;
  end_tick_ = segments_.at(last - brakes_).end_tick();
  // Only now: what is staged may be late, and then the machine stops where the earlier brake ends.
  rest_ = segments_.at(last).end;
  clock_.set_motion_end(rest_.tick);
  finish_batch();
  return true;
}

void ProgramRunner::halt() {
  end();
  brakes_ = 0;
  orders_.held = orders_.cancel = false;
}

std::uint32_t ProgramRunner::free() const {
  if (!begun_ || broken_off_) return motion::LineRing::capacity;
  const std::uint32_t known = lines_ + planning_.lines().inbox().size();
  return known < motion::LineRing::capacity ? motion::LineRing::capacity - known : 0;
}

std::uint32_t ProgramRunner::line() const {
  return begun_ && generator_.running() ? generator_.segment().point : 0;
}

std::uint32_t ProgramRunner::first_line_at_rest(bool& at_end) const {
  // A batch that was not run has consumed its lines.
  if (lost_ || staged_ || !planning_.work_exchange().is_owned() || !is_still()) return 0;
  StepPosition end{};
  const std::uint32_t line = planning_.lines().first_line(end);
  // A hold just before the end of the line leaves less than a step.
  const stepper::MotionState at = generator_.state();
  at_end = true;
  for (std::size_t a = 0; a < max_axes; ++a) at_end = at_end && at.axis[a].step() == end[a];
  return line;
}

bool ProgramRunner::played(std::uint64_t tick) const {
  return clock_.next_tick() >= tick + timed_ticks;
}

}  // namespace lamplock::machine
