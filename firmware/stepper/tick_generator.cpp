#include "firmware/stepper/tick_generator.hpp"

namespace lamplock::stepper {
namespace {
constexpr std::uint32_t no_end = 0xffffffffu;
/// Lead, cruise, tail.
constexpr std::uint32_t phases = 3;

void forget_shot(Segment& segment) {
  if (segment.has_shot()) segment.shot.present = false;
}
}  // namespace

TickGenerator::TickGenerator(SegmentQueue& queue, ChangeQueue* changes)
    : queue_(queue), changes_(changes) {
  for (Run& r : runs_) set_rest(r);
  set_position({});
}

void TickGenerator::set_position(const StepPosition& steps) {
  for (int a = 0; a < max_axes; ++a)
    runs_[index(a)].run.position_q64 = middle_of_step(steps[index(a)]);
}

void TickGenerator::set_motors(const StepPosition& motors) {
  set_position(motors);
  for (const AxisPair& pair : kinematics_.pairs()) {
    AxisRun &u = runs_[pair.first].run, &v = runs_[pair.second].run;
    const AxisRuns axes = axis_runs(pair, u, v);
    u = axes.first;
    v = axes.second;
  }
}

void TickGenerator::settle() {
  for (int a = 0; a < max_axes; ++a) {
    AxisRun& run = runs_[index(a)].run;
    if (!kinematics_.in_pair(a)) run.position_q64 = middle_of_step(run.step());
  }
  for (const AxisPair& pair : kinematics_.pairs())
    snap_to_motors(pair, runs_[pair.first].run.position_q64, runs_[pair.second].run.position_q64);
}

void TickGenerator::set_leads(const PerAxis<std::uint32_t>& ticks, std::int32_t laser_ticks) {
  laser_.lead = laser_ticks > 0 ? static_cast<std::uint32_t>(laser_ticks) : 0;
  laser_lag_ticks_ = laser_ticks < 0 ? static_cast<std::uint32_t>(-laser_ticks) : 0;
  lead_ = laser_.lead;
  for (int a = 0; a < max_axes; ++a) {
    runs_[index(a)].at.lead = ticks[index(a)];
    if (ticks[index(a)] > lead_) lead_ = ticks[index(a)];
  }
}

MotionState TickGenerator::state() const {
  if (running_ && left_ == 0) return segment().end;  // between two segments
  MotionState state;
  state.tick = head();
  for (int a = 0; a < max_axes; ++a) {
    Run r = runs_[index(a)];
    run_to_head(r, a);
    // The rate is the speed in the middle of a tick; the speed at its start is half an A less.
    state.axis[index(a)] = {r.run.position_q64, r.run.rate_q62 - r.run.accel_q62 / 2};
  }
  return state;
}

PerAxis<std::int64_t> TickGenerator::accelerations_q62() const {
  PerAxis<std::int64_t> accelerations{};
  if (!running_ || left_ == 0) return accelerations;
  for (int a = 0; a < max_axes; ++a) {
    Run r = runs_[index(a)];
    run_to_head(r, a);
    accelerations[index(a)] = acceleration_q62(r, a);
  }
  return accelerations;
}

std::int64_t TickGenerator::acceleration_q62(const Run& r, int a) const {
  if (r.run.accel_q62 == 0) return 0;
  const PhaseView phase = phase_of(queue_.at(r.at.segment).axis[index(a)], r.phase);
  if (phase.ramp == 0) return r.run.accel_q62;
  return straight_ramp_q62(phase.accel_q62, phase.ticks, phase.ramp, r.stair - 1u,
                           r.left + r.next_run);
}

[[gnu::noinline]] void TickGenerator::run_on(AxisRun& run, std::uint32_t ticks) {
  run.position_q64 = run.position_after(ticks);
  run.rate_q62 = run.rate_after(ticks);
}

void TickGenerator::go_on(Run& r, int a, std::uint32_t ticks) const {
  if (r.at.left == 0) return;
  if (!r.run.is_at_rest()) run_on(r.run, ticks);
  r.at.left -= ticks;
  r.left -= ticks;
  if (r.left != 0) return;
  if (r.at.left != 0) return next_piece(r, a);
  ++r.at.segment;
  set_rest(r);
}

/// Advances a copy of an axis as fill() will, up to the tick of the longest lead.
void TickGenerator::run_to_head(Run& r, int a) const {
  std::uint64_t tick = tick_ + r.at.lead;
  for (;;) {
    const std::uint32_t ticks = run_ticks(r, a, tick, static_cast<std::uint32_t>(head() - tick));
    if (ticks == 0) return;
    go_on(r, a, ticks);
    tick += ticks;
  }
}

/// At `tick` the head enters the next segment.
void TickGenerator::begin_segment(std::uint64_t tick) {
  if (running_ && left_ == 0) {
    const bool follows = !queue_.empty() && queue_.front().start_tick == tick;
    if (!follows && !segment().end.at_rest()) underrun_ = true;
    running_ = false;
  }
  if (running_ || queue_.empty() || queue_.front().start_tick > tick) return;
  // A late segment would arm its shots at wrong positions.
  if (queue_.front().start_tick < tick) {
    underrun_ = true;
  } else {
    left_ = queue_.front().ticks;
    queue_.begin_front();
    running_ = true;
  }
}

/// Begins all segments that start while the head passes these ticks.
void TickGenerator::begin_segments(std::uint32_t ticks) {
  for (std::uint64_t tick = head(); ticks != 0;) {
    begin_segment(tick);
    std::uint32_t n = ticks;
    if (running_) {
      if (left_ < n) n = left_;
      left_ -= n;
    } else if (!queue_.empty()) {
      n = limit_to(queue_.front().start_tick, tick, n);
    }
    tick += n;
    ticks -= n;
  }
}

/// True if a segment begins at `tick`. A brake may have cut a segment to no ticks.
bool TickGenerator::enter(Reader& reader, std::uint64_t tick) const {
  for (; reader.segment != queue_.begun(); ++reader.segment) {
    const Segment& s = queue_.at(reader.segment);
    if (s.start_tick != tick) return false;
    reader.left = s.ticks;
    if (s.ticks != 0) return true;
  }
  return false;
}

/// An axis enters the segment that begins at `tick`, or waits for it. Returns for how many ticks
/// its motion does not change.
std::uint32_t TickGenerator::wait(Run& r, int a, std::uint64_t tick, std::uint32_t ticks) const {
  if (r.at.left == 0 && enter(r.at, tick)) {
    const AxisProfile& p = queue_.at(r.at.segment).axis[index(a)];
    r.run.rate_q62 = p.speed_q62;
    r.run.accel_q62 = 0;
    r.next_run = 0;
    if (p.is_at_rest()) {
      r.left = r.at.left;
    } else {
      begin_phase(r, p, 0);
      next_piece(r, a);
    }
  }
  return limit_by(r.at, tick, ticks);
}

/// For how many of these ticks, the first one being `tick` of this axis, its motion does not
/// change.
std::uint32_t TickGenerator::run_ticks(Run& r, int a, std::uint64_t tick,
                                       std::uint32_t ticks) const {
  if (r.at.left == 0 && r.at.segment == queue_.begun()) return ticks;
  const std::uint32_t n = wait(r, a, tick, ticks);
  return r.left < n ? r.left : n;
}

[[gnu::noinline]] AxisRun TickGenerator::run_of_motor(const AxisPair& pair, bool second) const {
  return motor_run(pair, runs_[pair.first].run, runs_[pair.second].run, second);
}

/// As run_ticks(), for two axes that share motors.
std::uint32_t TickGenerator::pair_ticks(const AxisPair& pair, std::uint64_t tick,
                                        std::uint32_t ticks) {
  for (const bool second : {false, true}) {
    const int axis = pair.motor(second);
    ticks = run_ticks(runs_[index(axis)], axis, tick, ticks);
  }
  return ticks;
}

void TickGenerator::enter_lattice() {
  const Segment& segment = queue_.at(lattice_.segment);
  moves_ = moves(segment);
  if (segment.changes != 0 && changes_ != nullptr)
    changes_->grant(segment.changes, segment.start_tick);
  open_window();
}

void TickGenerator::open_window() {
  const Segment& segment = queue_.at(lattice_.segment);
  old_window_ = window_;
  window_ = Window{};
  if (!segment.has_shot()) return;
  const std::uint64_t centre = segment.end_tick() - arm_lead_ticks_;
  window_ = {centre - segment.shot.half_window_ticks, centre + segment.shot.half_window_ticks};
  if (segment.end_tick() <= cut_tick_) window_.cut(cut_tick_);
}

/// The segment at the head ends `ticks` earlier; true if the reader is no longer in it.
bool TickGenerator::shorten(Reader& reader, std::uint32_t ticks) const {
  if (reader.left == 0 || reader.segment + 1 != queue_.begun()) return false;
  reader.left -= ticks;
  if (reader.left != 0) return false;
  ++reader.segment;
  return true;
}

void TickGenerator::cut_windows() {
  cut_tick_ = head();
  window_.cut(cut_tick_);
  old_window_.cut(cut_tick_);
}

void TickGenerator::take_back_shot() {
  cut_windows();
  if (running_ && left_ != 0) forget_shot(queue_.at(queue_.begun() - 1));
}

void TickGenerator::replace(const Segment& segment) {
  cut_windows();
  if (running_ && left_ != 0) {
    Segment& cut = queue_.at(queue_.begun() - 1);
    cut.ticks -= left_;
    forget_shot(cut);
    for (Run& r : runs_) {
      if (shorten(r.at, left_)) set_rest(r);
      if (r.at.left != 0 && r.left > r.at.left) r.left = r.at.left;
    }
    shorten(lattice_, left_);
    shorten(laser_, left_);
  }
  queue_.push(segment);
  queue_.begin_front();
  running_ = true;
  left_ = segment.ticks;
}

void TickGenerator::halt() {
  running_ = underrun_ = false;
  window_ = old_window_ = Window{};
  queue_.clear();
  const auto leave = [this](Reader& reader) { reader.segment = queue_.begun(), reader.left = 0; };
  for (Run& r : runs_) {
    set_rest(r);
    leave(r.at);
  }
  leave(lattice_);
  leave(laser_);
  beam_.leave();
  queue_.release(queue_.begun());
}

void TickGenerator::set_rest(Run& r) {
  r.run.rate_q62 = r.run.accel_q62 = 0;
  r.left = no_end;
}

TickGenerator::PhaseView TickGenerator::phase_of(const AxisProfile& p, std::uint32_t phase) {
  if (phase == 0) return {p.lead_accel_q62, p.lead_ticks, p.lead_turn_ticks, p.lead_ramp};
  if (phase == 1) return {0, p.cruise_ticks, 0, 0};
  return {p.tail_accel_q62, p.tail_ticks, p.tail_turn_ticks, p.tail_ramp};
}

/// The first phase, from this one on, that is not empty.
TickGenerator::PhaseView TickGenerator::begin_phase(Run& r, const AxisProfile& p,
                                                    std::uint32_t phase) {
  if (phase == 0 && p.lead_ticks == 0) phase = 1;
  if (phase == 1 && p.cruise_ticks == 0) phase = 2;
  const PhaseView view = phase_of(p, phase);
  r.phase = phase & 0xffffu;
  r.stair = first_stair(view.ramp) & 0xffffu;
  r.to_turn = view.turn_ticks;
  return view;
}

/// Starts the next stair of the phase that a run is in; false if there is none.
bool TickGenerator::next_stair(Run& r, const PhaseView& phase) {
  if (phase.ticks == 0 || (phase.ramp == 0 && r.stair != 0)) return false;
  Stair stair;
  while (stepper::next_stair(phase.accel_q62, phase.ticks, phase.ramp, r.stair, stair)) {
    ++r.stair;
    if (stair.ticks == 0) continue;
    // The rate is the speed in the middle of a tick, half an A more than at its start.
    r.run.rate_q62 += stair.accel_q62 / 2 - r.run.accel_q62 / 2;
    r.run.accel_q62 = stair.accel_q62;
    r.left = stair.ticks;
    r.next_run = 0;
    if (r.to_turn != 0 && r.to_turn < stair.ticks) {
      r.left = r.to_turn;
      r.next_run = stair.ticks - r.to_turn;
    }
    r.to_turn = r.to_turn > stair.ticks ? r.to_turn - stair.ticks : 0;
    return true;
  }
  return false;
}

/// Pieces are the stairs of lead, cruise and tail; a stair in which the axis reverses is two
/// pieces.
void TickGenerator::next_piece(Run& r, const AxisProfile& p) {
  if (r.next_run != 0) {
    r.left = r.next_run;
    r.next_run = 0;
    return;
  }
  PhaseView view = phase_of(p, r.phase);
  while (!next_stair(r, view)) {
    if (r.phase + 1u >= phases) return set_rest(r);
    view = begin_phase(r, p, r.phase + 1u);
  }
}

void TickGenerator::next_piece(Run& r, int a) const {
  next_piece(r, queue_.at(r.at.segment).axis[index(a)]);
  // A brake may have cut the segment.
  if (r.left > r.at.left) r.left = r.at.left;
}

std::uint32_t TickGenerator::limit_to(std::uint64_t change, std::uint64_t tick,
                                      std::uint32_t ticks) {
  return change > tick && change - tick < ticks ? static_cast<std::uint32_t>(change - tick) : ticks;
}

/// Up to the end of the segment that a reader at `tick` is in, or to the start of the next.
std::uint32_t TickGenerator::limit_by(const Reader& reader, std::uint64_t tick,
                                      std::uint32_t ticks) const {
  if (reader.left != 0) return reader.left < ticks ? reader.left : ticks;
  if (reader.segment == queue_.begun()) return ticks;
  return limit_to(queue_.at(reader.segment).start_tick, tick, ticks);
}

std::uint32_t TickGenerator::limit_by_bits(std::uint64_t tick, std::uint32_t ticks) const {
  ticks = limit_to(window_.on, tick, ticks);
  ticks = limit_to(window_.off, tick, ticks);
  ticks = limit_to(old_window_.off, tick, ticks);
  if (trigger_.period_ticks == 0) return ticks;
  ticks = limit_to(trigger_on_, tick, ticks);
  return limit_to(trigger_on_ + trigger_.width_ticks, tick, ticks);
}

std::uint8_t TickGenerator::bits(std::uint64_t tick) const {
  const auto in = [tick](const Window& w) { return w.on <= tick && tick < w.off; };
  std::uint8_t bits = 0;
  if (in(window_) || in(old_window_)) bits |= arm_bit;
  if (trigger_.period_ticks != 0 && in({trigger_on_, trigger_on_ + trigger_.width_ticks}))
    bits |= trigger_bit;
  if (shines()) bits |= gate_bit;
  return bits;
}

void TickGenerator::pass(Reader& reader, std::uint32_t ticks) {
  if (reader.left == 0) return;
  reader.left -= ticks;
  if (reader.left == 0) ++reader.segment;
}

/// The lattice bits have advanced by n ticks to `tick`.
void TickGenerator::advance_bits(std::uint64_t tick, std::uint32_t ticks) {
  pass(lattice_, ticks);
  if (beam_.active()) beam_.pass(ticks);
  pass(laser_, ticks);
  if (trigger_.period_ticks == 0) return;
  if (trigger_on_ < tick) last_trigger_ = trigger_on_;
  while (trigger_on_ + trigger_.width_ticks <= tick) trigger_on_ += trigger_.period_ticks;
}

void TickGenerator::release() {
  // The end of the segment at the head is needed until the next one begins.
  const bool at_end = running_ && lattice_.segment == queue_.begun();
  const std::uint32_t passed = lattice_.segment - (at_end ? 1 : 0);
  const bool laser_last = static_cast<std::int32_t>(laser_.segment - passed) < 0;
  queue_.release(laser_last ? laser_.segment : passed);
}

void TickGenerator::advance(std::uint32_t ticks) {
  tick_ += ticks;
  for (int a = 0; a < max_axes; ++a)
    if (runs_[index(a)].at.left != 0) go_on(runs_[index(a)], a, ticks);
  if (running_) left_ -= ticks;
  advance_bits(tick_, ticks);
  release();
}

/// Up to where the motion of an axis or the windows of the present segment change.
std::uint32_t TickGenerator::limit_by_motion(std::uint32_t ticks) {
  begin_segment(head());
  if (running_ && left_ < ticks) ticks = left_;
  if (!running_ && !queue_.empty()) ticks = limit_to(queue_.front().start_tick, head(), ticks);
  for (int a = 0; a < max_axes; ++a)
    ticks = run_ticks(runs_[index(a)], a, tick_ + runs_[index(a)].at.lead, ticks);
  for (const AxisPair& pair : kinematics_.pairs()) {
    for (const bool second : {false, true})
      ticks = ticks_one_way(run_of_motor(pair, second), ticks);
  }
  if (lattice_.left == 0 && enter(lattice_, tick_)) enter_lattice();
  return limit_by_laser(tick_, limit_by(lattice_, tick_, ticks));
}

/// The laser enters the segment that begins for it at `tick` of the lattice. Returns for how many
/// of these ticks it stays in its segment.
std::uint32_t TickGenerator::limit_by_laser(std::uint64_t tick, std::uint32_t ticks) {
  if (tick < laser_lag_ticks_) return limit_to(laser_lag_ticks_, tick, ticks);
  const std::uint64_t at = tick + laser_.lead - laser_lag_ticks_;
  if (laser_.left == 0) enter_laser(at);
  const std::uint32_t n = limit_by(laser_, at, ticks);
  return beam_.active() ? beam_.limit(n) : n;
}

/// The laser enters the segment that begins at its own `tick`, if there is one.
void TickGenerator::enter_laser(std::uint64_t tick) {
  if (!enter(laser_, tick)) return beam_.leave();
  const Segment& segment = queue_.at(laser_.segment);
  power_axis_ = static_cast<std::int8_t>(power_axis(segment));
  if (segment.shines || beam_.active()) beam_.enter(segment);
}

PowerStretch TickGenerator::power_stretch(std::uint32_t tick) const {
  if (beam_.active()) return beam_.stretch();
  const Segment& s = queue_.at(laser_.segment);
  const std::uint32_t at = tick + laser_.lead - laser_lag_ticks_;
  return power_from(s.power, s.axis[index(power_axis_)],
                    at - static_cast<std::uint32_t>(s.start_tick));
}

/// Up to where the slope of the power changes.
std::uint32_t TickGenerator::limit_by_power(std::uint32_t ticks) const {
  if (!shines()) return ticks;
  const std::uint32_t left = power_stretch(static_cast<std::uint32_t>(tick_)).ticks;
  return left < ticks ? left : ticks;
}

void TickGenerator::fill(TickBlock& block, std::uint32_t max_ticks) {
  const std::uint32_t ticks = limit_by_power(limit_by_bits(tick_, limit_by_motion(max_ticks)));
  block.first_tick = tick_;
  block.ticks = ticks;
  block.bits = bits(tick_);
  block.moving = lattice_.segment != queue_.begun();
  const PowerStretch power =
      shines() ? power_stretch(static_cast<std::uint32_t>(tick_)) : PowerStretch{};
  block.power_q16 = power.power_q16;
  block.power_slope_q16 = power.slope_q16;
  for (int a = 0; a < max_axes; ++a) block.axis[index(a)] = runs_[index(a)].run;
  for (const AxisPair& pair : kinematics_.pairs()) {
    for (const bool second : {false, true})
      block.axis[index(pair.motor(second))] = run_of_motor(pair, second);
  }
  advance(ticks);
}

}  // namespace lamplock::stepper
