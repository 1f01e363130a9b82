// Judges of the pulses at the pins: motion and firing, judged only by the settings.
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

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/kinematics.hpp"
#include "shared/settings_table.hpp"
#include "sim/world/drive_settings.hpp"
#include "sim/world/lamp.hpp"
#include "sim/world/pins.hpp"

namespace lamplock::test {

/// Every edge of one wire; must outlive the bus's use.
class EdgeLog final : private sim::PinListener {
 public:
  struct Edge {
    bool level;
    sim::Picoseconds at;
  };
  EdgeLog(sim::PinBus& bus, sim::Pin pin) { bus.listen(pin, *this); }
  EdgeLog(const EdgeLog&) = delete;
  EdgeLog& operator=(const EdgeLog&) = delete;

  const std::vector<Edge>& edges() const { return edges_; }

 private:
  void pin_changed(sim::Pin /*pin*/, bool level, sim::Picoseconds at) override {
    edges_.push_back({level, at});
  }
  std::vector<Edge> edges_;
};

/// Listens from construction on; must outlive the bus's use.
class PinMonitor final : public sim::PinListener {
 public:
  struct Step {
    sim::Picoseconds at;
    std::int32_t position;  ///< after the step
    friend bool operator==(const Step&, const Step&) = default;
  };
  struct Fire {
    sim::Picoseconds rise;
    sim::Picoseconds fall;
    std::int64_t period;    ///< of the lamp, including drop-outs
    sim::Picoseconds edge;  ///< latest LAMP SYNC
    friend bool operator==(const Fire&, const Fire&) = default;
  };

  PinMonitor(sim::PinBus& bus, const sim::Lamp& lamp);
  PinMonitor(const PinMonitor&) = delete;
  PinMonitor& operator=(const PinMonitor&) = delete;

  void pin_changed(sim::Pin pin, bool level, sim::Picoseconds at) override;

  const std::vector<Step>& steps(int axis) const { return steps_[static_cast<std::size_t>(axis)]; }
  const std::vector<Fire>& fires() const { return fires_; }
  const std::vector<sim::Picoseconds>& edges() const { return edges_; }
  /// How often a shutter was opened, and how often while another one was open.
  int openings() const { return openings_; }
  int overlaps() const { return overlaps_; }

  bool nothing_happened() const;
  /// Position of an axis at a time: 0 before its first step.
  std::int32_t position_at(int axis, sim::Picoseconds at) const;
  /// Time of the first step of any axis, `never` without one; of the last step, 0 without one.
  sim::Picoseconds first_step() const;
  sim::Picoseconds last_step() const;
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
  int openings_ = 0, overlaps_ = 0;
  StepPosition position_{};
  std::array<std::vector<Step>, max_axes> steps_;
  std::vector<Fire> fires_;
  std::vector<sim::Picoseconds> edges_;
};

/// The steps of each motor as its drive reads them, in any pulse mode: own drives on the bus, from
/// construction on, without a lag; must outlive the bus's use.
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

}  // namespace lamplock::test
