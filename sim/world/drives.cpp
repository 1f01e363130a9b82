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
      min_period_(from_ns(config.min_period_ns)),
      dir_setup_(from_ns(config.dir_setup_ns)) {
  for (int axis = 0; axis < max_axes; ++axis) {
    bus.listen(step_pin(axis), *this);
    bus.listen(dir_pin(axis), *this);
    axes_[static_cast<std::size_t>(axis)].direction = bus.level(dir_pin(axis)) ? -1 : 1;
    lag_[static_cast<std::size_t>(axis)] =
        from_ns(1000 * config.lag_us[static_cast<std::size_t>(axis)]);
  }
}

StepPosition Drives::position() const {
  StepPosition result{};
  std::transform(axes_.begin(), axes_.end(), result.begin(),
                 [](const Axis& axis) { return axis.position; });
  return result;
}

StepPosition Drives::position_at(Picoseconds at) const {
  const auto undo = [at](const Axis& axis, Picoseconds lag) {
    std::int32_t position = axis.position;
    for (std::uint32_t back = 1; back <= remembered_steps; ++back) {
      const Step& step = axis.recent[(axis.steps - back) % remembered_steps];
      if (step.at + lag <= at) break;  // also ends at slots never written: they are long ago
      position = step.position_before;
    }
    return position;
  };
  StepPosition result{};
  std::transform(axes_.begin(), axes_.end(), lag_.begin(), result.begin(), undo);
  return result;
}

std::uint64_t Drives::total_faults() const {
  std::uint64_t sum = 0;
  for (const Axis& axis : axes_) sum += axis.faults.total();
  return sum;
}

}  // namespace lamplock::sim
