// Judges every tick of a virtual board by the settings: speed and acceleration of each axis for any
// motors, continuity of steps, the work space.
//
// In:  the board's ticks (tick_listener.hpp). Out: the first broken rule, the begin and end of
//      motion, the largest change of speed in a window of time.
//
// Inside a block an axis has constant acceleration within its setting. Between blocks its speed may
// jump at corners, which are passed at a speed (junction deviation); at a sharp one by up to the
// square root of 8 a d, with the acceleration along the corner, which two or three axes may share.
#pragma once

#include <deque>
#include <string>

#include "shared/settings_table.hpp"
#include "shared/work_space.hpp"
#include "sim/virtual_board/virtual_board.hpp"

namespace lamplock::test {

class MotionJudge final : public sim::TickListener {
 public:
  MotionJudge(sim::VirtualBoard& board, const settings::Values& values, bool corners);

  /// The planner's own rounding, well under a percent.
  static constexpr double margin = 1.002;

  /// Homing sets the position of axes at rest.
  void expect_homing() { homes_ = true; }
  const std::string& fault() const { return fault_; }
  /// Seconds from the first to the last tick with motion, of the present motion.
  double moved_s() const { return static_cast<double>(last_ - first_) * tick_s; }
  std::uint64_t moving_ticks() const { return moving_ticks_; }
  void begin() { first_ = last_ = moving_ticks_ = 0; }
  /// Largest change of speed in `window_ticks`, relative to what the acceleration allows.
  double hardest() const { return hardest_; }
  static constexpr std::uint64_t window_ticks = 20'000;

  void ticks_played(const sim::PlayedTicks& played) override;
  void beat_begins(std::uint64_t, sim::Picoseconds) override {}

 private:
  static constexpr double tick_s = 1e-6;
  /// On a segment of n ticks the speed may jump by up to 4/n of itself (line/profile.hpp); on the
  /// shortest segments that is little more than this.
  static constexpr double rounding = 0.01;

  struct Rules {
    double speed = 0, accel = 0, jump = 0;  ///< in steps per tick
  };
  struct Axis {
    Int128 place;
    double speed = 0;
  };
  struct Sample {
    std::uint64_t tick;
    PerAxis<double> speed;
  };

  bool check_motors(const PerAxis<stepper::AxisRun>& motors, std::uint32_t skipped,
                    std::uint32_t ticks);
  void judge(int a, std::uint64_t tick, double first, double last, double accel);
  void window(std::uint64_t tick);
  void note(int axis, std::uint64_t tick, const char* what, double seen, double most);

  StepLimits space_;
  int axes_;
  Kinematics kinematics_;
  PerAxis<Rules> rules_{};
  PerAxis<Axis> at_{};
  PerAxis<std::int64_t> motor_steps_{};  ///< after the latest tick
  bool known_ = false, homes_ = false;
  std::uint64_t first_ = 0, last_ = 0, moving_ticks_ = 0;
  double hardest_ = 0;
  std::deque<Sample> samples_;
  std::string fault_;
};

}  // namespace lamplock::test
