// The steps of a machine as its drives read them, in any pulse mode.
//
// In:  the two wires of each motor, the settings that define them. Out: every step with its time,
// in
//      order for each motor.
// Used by tests that compare modes or boards.
#pragma once

#include <vector>

#include "sim/world/drive_settings.hpp"
#include "tests/judges/pin_monitor.hpp"

namespace lamplock::test {

/// Own drives on the bus, from construction on, without a lag; must outlive the bus's use.
class StepLog final : private sim::LoadListener {
 public:
  StepLog(const settings::Values& values, sim::PinBus& bus) : drives_(motors_of(values), bus) {
    for (int axis = 0; axis < max_axes; ++axis) drives_.listen(axis, *this);
  }
  StepLog(const StepLog&) = delete;
  StepLog& operator=(const StepLog&) = delete;

  const PerAxis<std::vector<PinMonitor::Step>>& steps() const { return steps_; }
  std::size_t total() const {
    std::size_t sum = 0;
    for (const auto& axis : steps_) sum += axis.size();
    return sum;
  }
  /// Times of all steps in the opposite direction of the step before.
  std::vector<sim::Picoseconds> reversals(int axis) const {
    std::vector<sim::Picoseconds> times;
    const auto& all = steps_[index(axis)];
    for (std::size_t i = 2; i < all.size(); ++i)
      if (all[i].position == all[i - 2].position) times.push_back(all[i].at);
    return times;
  }

 private:
  /// The drives, whatever axes they move.
  static sim::DriveConfig motors_of(const settings::Values& values) {
    sim::DriveConfig drives = sim::drives_of(values);
    drives.kinematics = {};
    return drives;
  }
  void load_moves(int axis, std::int32_t place, sim::Picoseconds at) override {
    steps_[index(axis)].push_back({at, place});
  }

  sim::Drives drives_;
  PerAxis<std::vector<PinMonitor::Step>> steps_;
};

/// Sets the pulses as in the settings table.
inline void set_pulses(settings::Values& values, const PerAxis<settings::PulseMode>& modes,
                       int step_invert, int direction_invert, std::int32_t setup_ns,
                       std::int32_t hold_ns) {
  using settings::Id;
  for (int axis = 0; axis < max_axes; ++axis)
    values.set_milli(settings::for_axis(Id::pulse_mode_x, axis),
                     static_cast<int>(modes[index(axis)]) * 1000);
  values.set_milli(Id::step_invert, step_invert * 1000);
  values.set_milli(Id::direction_invert, direction_invert * 1000);
  values.set_milli(Id::direction_setup, setup_ns);
  values.set_milli(Id::direction_hold, hold_ns);
}

}  // namespace lamplock::test
