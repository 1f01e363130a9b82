#include "sim/world/drives.hpp"

#include <algorithm>
#include <cmath>

namespace lamplock::sim {
namespace {

Picoseconds from_ns(double ns) {
  return static_cast<Picoseconds>(std::llround(ns * static_cast<double>(ps_per_ns)));
}

}  // namespace

Drives::Drives(const DriveConfig& config, PinBus& bus)
    : min_pulse_(from_ns(config.min_pulse_ns)),
      min_low_(from_ns(config.min_low_ns)),
      min_period_(from_ns(config.min_period_ns)),
      dir_setup_(from_ns(config.dir_setup_ns)),
      dir_hold_(from_ns(config.dir_hold_ns)),
      quadrature_gap_(from_ns(config.quadrature_gap_ns)),
      wake_(from_ns(1e6 * config.wake_ms)),
      axes_of_enable_z_(config.axes_of_enable_z),
      kinematics_(config.kinematics) {
  bus.listen(Pin::enable, *this);
  bus.listen(Pin::enable_z, *this);
  const StepPosition start = kinematics_.motors_of_loads(config.start);
  for (int number = 0; number < max_axes; ++number) {
    bus.listen(step_pin(number), *this);
    bus.listen(dir_pin(number), *this);
    Axis& axis = axes_[index(number)];
    axis.number = number;
    axis.mode = config.mode[index(number)];
    axis.inverted = {config.first_active_low[index(number)],
                     config.second_active_low[index(number)]};
    axis.plain = axis.mode == PulseMode::step_dir && !axis.inverted[0] && !axis.inverted[1];
    axis.active = {bus.level(step_pin(number)) != axis.inverted[0],
                   bus.level(dir_pin(number)) != axis.inverted[1]};
    axis.direction = axis.active[1] ? -1 : 1;
    axis.position = start[index(number)];
    axis.lag = from_ns(1000 * config.lag_us[index(number)]);
  }
}

/// At power-up drives are on before the first step comes.
void Drives::power(Pin pin, bool on, Picoseconds at) {
  for (Axis& axis : axes_) {
    const bool on_z = (axes_of_enable_z_ >> axis.number & 1u) != 0;
    if (on_z != (pin == Pin::enable_z)) continue;
    if (on && axis.released) axis.powered = at + wake_;
    axis.released = !on;
  }
}

/// Inverted wires and other modes.
void Drives::special_changed(Axis& axis, std::size_t wire, bool level, Picoseconds at) {
  const bool active = level != axis.inverted[wire];
  axis.active[wire] = active;
  if (axis.mode == PulseMode::cw_ccw)
    pulse_changed(axis, wire, active, at);
  else if (axis.mode == PulseMode::quadrature)
    quadrature_changed(axis, wire, active, at);
  else if (wire != 0)
    turn(axis, active, at);
  else if (active)
    step(axis, at);
  else
    fall(axis, at);
  axis.last_change[wire] = at;
}

/// A motor has made a step in direction `way`.
void Drives::report(const Axis& axis, std::int32_t way, Picoseconds at) const {
  const StepPosition now = motors();
  StepPosition before = now;
  before[index(axis.number)] -= way;
  const StepPosition loads = kinematics_.loads_of(now), old = kinematics_.loads_of(before);
  for (const Axis& load : axes_) {
    const std::size_t i = index(load.number);
    if (loads[i] == old[i]) continue;
    for (LoadListener* listener : load.listeners)
      listener->load_moves(load.number, loads[i], at + axis.lag);
  }
}

/// CW is the first wire. The last change of a wire that is low is the end of its last pulse.
void Drives::pulse_changed(Axis& axis, std::size_t wire, bool active, Picoseconds at) {
  const std::size_t other = 1 - wire;
  if (active && at - axis.last_change[wire] < min_low_) ++axis.faults.short_pauses;
  if (!active) {
    if (at - axis.last_change[wire] < min_pulse_) ++axis.faults.short_pulses;
    return;
  }
  if (axis.active[other])
    ++axis.faults.both_high;
  else if (at - axis.last_change[other] < dir_setup_)
    ++axis.faults.late_directions;
  move(axis, wire == 0 ? 1 : -1, at);
}

/// A is the first wire. Up is 00, 10, 11, 01 (A B): A changes to the inverse of B, or B to the
/// value of A.
void Drives::quadrature_changed(Axis& axis, std::size_t wire, bool active, Picoseconds at) {
  const std::size_t other = 1 - wire;
  // A decoder samples: it cannot decide the order of two edges in one sample.
  if (at - axis.last_change[other] < quadrature_gap_) ++axis.faults.quadrature_jumps;
  if (at - axis.last_change[wire] < min_pulse_) ++axis.faults.short_pulses;
  const bool differ = active != axis.active[other];
  move(axis, differ == (wire == 0) ? 1 : -1, at);
}

StepPosition Drives::position() const { return kinematics_.loads_of(motors()); }

StepPosition Drives::motors() const {
  StepPosition result{};
  std::transform(axes_.begin(), axes_.end(), result.begin(),
                 [](const Axis& axis) { return axis.position; });
  return result;
}

StepPosition Drives::position_at(Picoseconds at) const {
  const auto undo = [at](const Axis& axis) {
    std::int32_t position = axis.position;
    for (std::uint32_t back = 1; back <= remembered_steps; ++back) {
      const Step& step = axis.recent[(axis.steps - back) % remembered_steps];
      if (step.at + axis.lag <= at) break;  // also ends at slots never written: they are long ago
      position = step.position_before;
    }
    return position;
  };
  StepPosition result{};
  std::transform(axes_.begin(), axes_.end(), result.begin(), undo);
  return kinematics_.loads_of(result);
}

std::uint64_t Drives::total_faults() const {
  std::uint64_t sum = 0;
  for (const Axis& axis : axes_) sum += axis.faults.total();
  return sum;
}

}  // namespace lamplock::sim
