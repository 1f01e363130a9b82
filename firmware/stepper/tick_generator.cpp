// The tick generator as a whole: positions, leads, beginning of segments, brake, stop, blocks.
#include "firmware/stepper/tick_generator.hpp"

namespace lamplock::stepper {
namespace {

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
    if (runs_[index(a)].at.left != 0) advance_run(runs_[index(a)], a, ticks);
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
  block.power_scale_q15 = power_scale_q15_;
  for (int a = 0; a < max_axes; ++a) block.axis[index(a)] = runs_[index(a)].run;
  for (const AxisPair& pair : kinematics_.pairs()) {
    for (const bool second : {false, true})
      block.axis[index(pair.motor(second))] = run_of_motor(pair, second);
  }
  advance(ticks);
}

}  // namespace lamplock::stepper
