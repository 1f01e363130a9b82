// An independent check of motion and firing at the pins, judged only by the settings.
//
// In:  edges of STEP, DIR and Q-SWITCH with their times.
// Out: the first broken rule as text, or nothing. Nothing of the firmware is used.
//
// Resolution of the pins: a board outputs a step at the start of the tick in which the position
// crosses it, so at any time t the count of steps is the true position at most one tick later,
// rounded down. Differences of counts are therefore within one step (second differences: within
// two) and the distance of one tick of the true ones. As slave a tick may be stretched or shrunk by
// the slew limit to follow the lamp: 2 slew h of time between two neighbouring windows of h.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/kinematics.hpp"
#include "shared/settings_table.hpp"
#include "sim/world/lamp.hpp"
#include "sim/world/pins.hpp"

namespace lamplock::test {

/// Listens from construction on; must outlive the bus's use.
class PinMonitor final : public sim::PinListener {
 public:
  struct Step {
    sim::Picoseconds at;
    std::int32_t position;  ///< after the step
  };
  struct Fire {
    sim::Picoseconds rise;
    sim::Picoseconds fall;
    std::int64_t period;    ///< of the lamp, including drop-outs
    sim::Picoseconds edge;  ///< latest LAMP SYNC
  };

  PinMonitor(sim::PinBus& bus, const sim::Lamp& lamp);
  PinMonitor(const PinMonitor&) = delete;
  PinMonitor& operator=(const PinMonitor&) = delete;

  void pin_changed(sim::Pin pin, bool level, sim::Picoseconds at) override;

  const std::vector<Step>& steps(int axis) const { return steps_[static_cast<std::size_t>(axis)]; }
  const std::vector<Fire>& fires() const { return fires_; }
  const std::vector<sim::Picoseconds>& edges() const { return edges_; }

  bool nothing_happened() const;
  /// True if any axis stepped in (from, to].
  bool stepped(sim::Picoseconds from, sim::Picoseconds to) const;
  /// Shots that began in (from, to].
  std::size_t fired(sim::Picoseconds from, sim::Picoseconds to) const;

  /// From now on corners are judged by the set speed jumps: for jobs in path mode.
  void allow_speed_jumps() { speed_jumps_ = true; }

  /// Checks speed, acceleration and work space between two times: the first violation, or an empty
  /// text. The machine must be at rest at `from`; events after `to` are ignored.
  std::string violation(const settings::Values& values, sim::Picoseconds from = 0,
                        sim::Picoseconds to = sim::never) const;

 private:
  struct Rules {
    double speed, accel, tick_s, slew;
    double jump = 0;       ///< of the speed at a corner
    double corners_s = 0;  ///< maximum number of corners per second
  };

  Rules rules_of(const settings::Values& values, int axis) const;

  static std::string judge(const Rules& rules, const settings::Values& values, int axis,
                           std::int32_t before, const std::vector<Step>& steps,
                           sim::Picoseconds to);

  static std::string judge_window(const Rules& rules, int axis, std::int32_t before,
                                  const std::vector<Step>& steps, double h, sim::Picoseconds to);

  sim::PinBus& bus_;
  const sim::Lamp& lamp_;
  bool speed_jumps_ = false;
  StepPosition position_{};
  std::array<std::vector<Step>, max_axes> steps_;
  std::vector<Fire> fires_;
  std::vector<sim::Picoseconds> edges_;
};

}  // namespace lamplock::test
