// The two wires of an axis, as a board drives them.
//
// In:  blocks of ticks with the steps of the axis by closed form (StepCursor), the time of a tick.
// Out: levels on the bus: STEP and DIR, CW and CCW, or A and B, inverted or not; a pulse lasts
//      0.5 us or whole ticks (shared/pulse_times.hpp). Around a reversal the guard of the firmware
//      decides, tick by tick, when DIR changes and which steps wait (stepper/reversal_guard.hpp).
// Who: VirtualBoard, for every run of ticks it puts out. Costs a comparison while no axis reverses.
#pragma once

#include <algorithm>
#include <cstdint>

#include "firmware/stepper/pulse_output.hpp"
#include "firmware/stepper/tick_block.hpp"
#include "sim/virtual_board/step_edges.hpp"
#include "sim/world/pins.hpp"

namespace lamplock::sim {

class AxisOutput {
 public:
  /// At power-up: sets the wires to their levels at rest.
  void start(PinBus& bus, int axis, const stepper::PulseOutput& output) {
    bus_ = &bus;
    axis_ = axis;
    pulses_ = output.axis[index(axis)];
    set_times(output);
    guard_.begin(false);
    put(0, false, 0);
    put(1, false, 0);
  }
  /// Other times; no step is owed.
  void set_times(const stepper::PulseOutput& output) {
    high_ticks_ = output.pulses.high_ticks;
    guard_.set_times(output.times);
  }
  /// Puts out ticks `from` to `to` of a block, the last one not included.
  template <class TimeOfTick>
  void play(const stepper::TickBlock& block, StepCursor& cursor, std::uint64_t from,
            std::uint64_t to, TimeOfTick&& time_of) {
    const stepper::AxisRun& run = block.axis[index(axis_)];
    if (!passes(block, run)) play_guarded(block, cursor, from, to, time_of);
    for (; cursor.tick() != StepCursor::none && block.first_tick + cursor.tick() < to;
         cursor.next()) {
      step(block.first_tick + cursor.tick(), time_of);
    }
  }
  /// Steps of the motion that the guard has not put out yet.
  std::int32_t owed() const { return guard_.owed(); }
  /// The ticks end: steps not put out are dropped.
  void stop() { guard_.begin(guard_.back()); }

 private:
  bool passes(const stepper::TickBlock& block, const stepper::AxisRun& run) const {
    if (!block.moving || run.is_at_rest()) return guard_.settled();
    return guard_.passes(run.backwards());
  }

  template <class TimeOfTick>
  void play_guarded(const stepper::TickBlock& block, StepCursor& cursor, std::uint64_t from,
                    std::uint64_t to, TimeOfTick&& time_of) {
    const stepper::AxisRun& run = block.axis[index(axis_)];
    const bool back = run.backwards();
    if (guard_.settled()) {
      constexpr std::uint64_t long_ago = 1000;
      guard_.wake(static_cast<std::uint32_t>(std::min(from - last_step_, long_ago)));
    }
    for (std::uint64_t tick = from; tick < to && !passes(block, run); ++tick) {
      const auto n = static_cast<std::uint32_t>(tick - block.first_tick);
      if (block.moving && run.rate_after(n) != 0) guard_.head(back);
      const bool wanted = cursor.tick() == n;
      if (wanted) cursor.next();
      const bool was_back = guard_.back();
      const bool steps = guard_.tick(wanted ? (back ? -1 : 1) : 0);
      if (guard_.back() != was_back) turn(time_of(tick));
      if (steps) step(tick, time_of);
    }
  }

  void turn(Picoseconds at) {
    if (pulses_.mode == stepper::PulseMode::step_dir) put(1, guard_.back(), at);
  }
  template <class TimeOfTick>
  void step(std::uint64_t tick, TimeOfTick&& time_of) {
    last_step_ = tick;
    const Picoseconds at = time_of(tick);
    if (pulses_.mode == stepper::PulseMode::quadrature) {
      place_ += guard_.back() ? ~0u : 1u;
      const std::uint32_t levels = stepper::quadrature_levels(place_);
      put(0, (levels & 1) != 0, at);
      put(1, (levels & 2) != 0, at);
      return;
    }
    const int wire = pulses_.mode == stepper::PulseMode::cw_ccw && guard_.back() ? 1 : 0;
    put(wire, true, at);
    put(wire, false,
        high_ticks_ == 0 ? at + short_pulse_ns * ps_per_ns : time_of(tick + high_ticks_));
  }
  void put(int wire, bool active, Picoseconds at) {
    const bool inverted = wire == 0 ? pulses_.first_inverted : pulses_.second_inverted;
    bus_->set(wire == 0 ? step_pin(axis_) : dir_pin(axis_), active != inverted, at);
  }

  PinBus* bus_ = nullptr;
  int axis_ = 0;
  stepper::AxisPulses pulses_;
  stepper::ReversalGuard guard_;
  std::uint32_t high_ticks_ = 0;  ///< 0: short pulses
  std::uint64_t last_step_ = 0;   ///< tick of it; none before tick 1
  std::uint32_t place_ = 0;       ///< steps put out, modulo 2^32
};

}  // namespace lamplock::sim
