#include "tests/judges/motion_judge.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace lamplock::test {
namespace {

double real(std::int64_t q62) { return std::ldexp(static_cast<double>(q62), -62); }

}  // namespace

MotionJudge::MotionJudge(sim::VirtualBoard& board, const settings::Values& values, bool corners)
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
      rules.jump = std::sqrt(8 * std::sqrt(axes_) * accel_mm_s2 * deviation_mm) * steps_mm * tick_s;
  }
  board.listen(*this);
}

void MotionJudge::ticks_played(const sim::PlayedTicks& played) {
  const auto skipped = static_cast<std::uint32_t>(played.from - played.block.first_tick);
  const auto ticks = static_cast<std::uint32_t>(played.to - played.from);
  if (ticks == 0) return;
  bool moves = false;
  const PerAxis<stepper::AxisRun> runs = stepper::axis_runs(kinematics_, played.block.axis);
  const bool motors_stay = check_motors(played.block.axis, skipped, ticks);
  for (int a = 0; a < axes_; ++a) {
    const stepper::AxisRun& run = runs[index(a)];
    Axis& axis = at_[index(a)];
    const Int128 place = run.position_after(skipped);
    // At rest an axis may settle to the whole steps of the motors.
    const bool settles =
        homes_ ? axis.speed <= 2 * rules_[index(a)].accel : axis.speed == 0 && motors_stay;
    if (known_ && !(place == axis.place) && !settles) note(a, played.from, "jumps", 0, 0);
    axis.place = run.position_after(skipped + ticks);
    if (!played.block.moving || run.is_at_rest()) {
      judge(a, played.from, 0, 0, 0);
      continue;
    }
    moves = true;
    judge(a, played.from, real(run.rate_after(skipped)), real(run.rate_after(skipped + ticks - 1)),
          real(run.accel_q62));
  }
  if (moves) {
    if (moving_ticks_ == 0) first_ = played.from;
    last_ = played.to;
    moving_ticks_ += ticks;
  }
  known_ = true;
  window(played.to);
}

/// Records the steps of the motors after some ticks; true if they begin at the recorded ones.
bool MotionJudge::check_motors(const PerAxis<stepper::AxisRun>& motors, std::uint32_t skipped,
                               std::uint32_t ticks) {
  bool stay = true;
  for (int a = 0; a < axes_; ++a) {
    const stepper::AxisRun& run = motors[index(a)];
    stay = stay && run.position_after(skipped).hi() == motor_steps_[index(a)];
    motor_steps_[index(a)] = run.position_after(skipped + ticks).hi();
  }
  return stay;
}

void MotionJudge::judge(int a, std::uint64_t tick, double first, double last, double accel) {
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

void MotionJudge::window(std::uint64_t tick) {
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

void MotionJudge::note(int axis, std::uint64_t tick, const char* what, double seen, double most) {
  if (fault_.empty())
    fault_ =
        fmt::format("axis {} {} at tick {}: {} where {} is allowed", axis, what, tick, seen, most);
}

}  // namespace lamplock::test
