// What a virtual board makes of every tick, judged by the settings: speed and acceleration of each
// axis, whichever motors move it, steps that join, the work space.
//
// In:  the board's ticks (tick_listener.hpp). Out: the first rule that was broken, when motion
// began
//      and ended, the largest change of speed in a window of time.
//
// Inside a block an axis has constant acceleration: what a setting allows. From block to block its
// speed may jump in corners, which are run through at a speed (junction deviation); a sharp one by
// up to the square root of 8 a d, with the acceleration along the corner, which two or three axes
// may share.
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <string>

#include <fmt/format.h>

#include "shared/settings_table.hpp"
#include "shared/work_space.hpp"
#include "sim/virtual_board/virtual_board.hpp"

namespace lamplock::test {

class MotionJudge final : public sim::TickListener {
 public:
  MotionJudge(sim::VirtualBoard& board, const settings::Values& values, bool corners)
      : space_(work_space(values)),
        axes_(values.whole(settings::Id::axes)),
        kinematics_(board.controller().runner().generator().kinematics()) {
    using settings::Id;
    const double deviation_mm = values.milli(Id::junction_deviation) / 1e3;
    for (int a = 0; a < axes_; ++a) {
      Rules& rules = rules_[index(a)];
      const double steps_mm = values.milli(Id::steps_per_mm_x, a) / 1e3;
      const double accel_mm_s2 = values.milli(Id::acceleration_x, a) / 1e3;
      rules.speed = values.milli(Id::max_rate_x, a) / 6e4 * steps_mm * tick_s;
      rules.accel = accel_mm_s2 * steps_mm * tick_s * tick_s;
      if (corners)
        rules.jump =
            std::sqrt(8 * std::sqrt(axes_) * accel_mm_s2 * deviation_mm) * steps_mm * tick_s;
    }
    board.listen(*this);
  }

  /// The planner's own rounding, well under a percent.
  static constexpr double margin = 1.002;

  /// Homing tells axes that stand where they are.
  void expect_homing() { homes_ = true; }
  const std::string& fault() const { return fault_; }
  /// Seconds from the first tick that moved to the last one, of the present motion.
  double moved_s() const { return static_cast<double>(last_ - first_) * tick_s; }
  std::uint64_t moving_ticks() const { return moving_ticks_; }
  void begin() { first_ = last_ = moving_ticks_ = 0; }
  /// Largest change of speed in `window_ticks`, over what the acceleration allows.
  double hardest() const { return hardest_; }
  static constexpr std::uint64_t window_ticks = 20'000;

  void ticks_played(const sim::PlayedTicks& played) override {
    const auto skipped = static_cast<std::uint32_t>(played.from - played.block.first_tick);
    const auto ticks = static_cast<std::uint32_t>(played.to - played.from);
    if (ticks == 0) return;
    bool moves = false;
    const PerAxis<stepper::AxisRun> runs = stepper::axis_runs(kinematics_, played.block.axis);
    for (int a = 0; a < axes_; ++a) {
      const stepper::AxisRun& run = runs[index(a)];
      Axis& axis = at_[index(a)];
      const Int128 place = run.position_after(skipped);
      // At rest it may settle in the middle of its step.
      const bool settles = homes_ ? axis.speed <= 2 * rules_[index(a)].accel
                                  : axis.speed == 0 && place.hi() == axis.place.hi();
      if (known_ && !(place == axis.place) && !settles) note(a, played.from, "jumps", 0, 0);
      axis.place = run.position_after(skipped + ticks);
      if (!played.block.moving || run.stands()) {
        judge(a, played.from, 0, 0, 0);
        continue;
      }
      moves = true;
      judge(a, played.from, real(run.rate_after(skipped)),
            real(run.rate_after(skipped + ticks - 1)), real(run.accel_q62));
    }
    if (moves) {
      if (moving_ticks_ == 0) first_ = played.from;
      last_ = played.to;
      moving_ticks_ += ticks;
    }
    known_ = true;
    window(played.to);
  }
  void beat_begins(std::uint64_t, sim::Picoseconds) override {}

 private:
  static constexpr double tick_s = 1e-6;
  /// On a segment of n ticks the speed may jump by up to 4/n of itself (line_profile.hpp): of the
  /// shortest segments that is not much more than this.
  static constexpr double rounding = 0.01;

  struct Rules {
    double speed = 0, accel = 0, jump = 0;  ///< steps a tick, of a tick
  };
  struct Axis {
    Int128 place;
    double speed = 0;
  };
  struct Sample {
    std::uint64_t tick;
    PerAxis<double> speed;
  };

  static double real(std::int64_t q62) { return std::ldexp(static_cast<double>(q62), -62); }

  void judge(int a, std::uint64_t tick, double first, double last, double accel) {
    const Rules& rules = rules_[index(a)];
    Axis& axis = at_[index(a)];
    const double fastest = std::max(std::abs(first), std::abs(last));
    if (fastest > rules.speed * margin) note(a, tick, "is too fast", fastest, rules.speed);
    if (std::abs(accel) > rules.accel * margin)
      note(a, tick, "accelerates too hard", std::abs(accel), rules.accel);
    const double jump = std::abs(first - axis.speed);
    const double most = rules.accel * 2 + rules.jump + rounding * std::max(fastest, axis.speed);
    if (known_ && jump > most) note(a, tick, "jumps in speed", jump, most);
    axis.speed = last;
    const auto step = static_cast<std::int32_t>(axis.place.hi());
    if (!space_.contains(a, step)) note(a, tick, "leaves the work space", step, 0);
  }

  void window(std::uint64_t tick) {
    Sample now{tick, {}};
    for (int a = 0; a < axes_; ++a) now.speed[index(a)] = at_[index(a)].speed;
    samples_.push_back(now);
    while (samples_.size() > 1 && samples_[1].tick + window_ticks <= tick) samples_.pop_front();
    const double ticks = static_cast<double>(tick - samples_.front().tick);
    if (ticks < static_cast<double>(window_ticks)) return;
    for (int a = 0; a < axes_; ++a) {
      const double change = std::abs(now.speed[index(a)] - samples_.front().speed[index(a)]);
      hardest_ = std::max(hardest_, change / (ticks * rules_[index(a)].accel));
    }
  }

  void note(int axis, std::uint64_t tick, const char* what, double seen, double most) {
    if (fault_.empty())
      fault_ = fmt::format("axis {} {} at tick {}: {} where {} is allowed", axis, what, tick, seen,
                           most);
  }

  StepLimits space_;
  int axes_;
  Kinematics kinematics_;
  PerAxis<Rules> rules_{};
  PerAxis<Axis> at_{};
  bool known_ = false, homes_ = false;
  std::uint64_t first_ = 0, last_ = 0, moving_ticks_ = 0;
  double hardest_ = 0;
  std::deque<Sample> samples_;
  std::string fault_;
};

}  // namespace lamplock::test
