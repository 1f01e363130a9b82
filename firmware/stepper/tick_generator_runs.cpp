// Runs of the tick generator: each axis in its segments, in pieces of constant acceleration.
#include "firmware/stepper/tick_generator.hpp"

namespace lamplock::stepper {
namespace {

constexpr std::uint32_t no_end = 0xffffffffu;
/// Lead, cruise, tail.
constexpr std::uint32_t phases = 3;

}  // namespace

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

void TickGenerator::advance_run(Run& r, int a, std::uint32_t ticks) const {
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
    advance_run(r, a, ticks);
    tick += ticks;
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

/// Up to the end of the segment that a reader at `tick` is in, or to the start of the next.
std::uint32_t TickGenerator::limit_by(const Reader& reader, std::uint64_t tick,
                                      std::uint32_t ticks) const {
  if (reader.left != 0) return reader.left < ticks ? reader.left : ticks;
  if (reader.segment == queue_.begun()) return ticks;
  return limit_to(queue_.at(reader.segment).start_tick, tick, ticks);
}

}  // namespace lamplock::stepper
