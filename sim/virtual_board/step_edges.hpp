// Steps of a block by closed form: the ticks at which an axis takes its steps.
//
// In:  one axis of a block.
// Out: the tick of every step, in order. The same ticks as adding the rate tick by tick (a test
//      compares them), at a cost per step instead of per tick.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "firmware/stepper/tick_block.hpp"

namespace lamplock::sim {

/// Walks over the steps of one axis in one block.
class StepCursor {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  StepCursor() = default;
  StepCursor(const stepper::AxisRun& run, std::uint32_t ticks)
      : run_(&run),
        ticks_(ticks),
        up_(run.rate_q62 > 0 || (run.rate_q62 == 0 && run.accel_q62 > 0)),
        step_(run.position_q64.hi()),
        last_(run.position_after(ticks).hi()) {
    const double rate = std::ldexp(static_cast<double>(run.rate_q62), -62);
    const double accel = std::ldexp(static_cast<double>(run.accel_q62), -62);
    speed_ = std::fabs(rate - accel / 2);
    accel_ = up_ ? accel : -accel;
    advance();
  }

  /// Tick of the block that takes the next step; none if there are no more steps.
  std::uint32_t tick() const { return tick_; }
  bool backwards() const { return !up_; }
  /// Advances to the next step.
  void next() { advance(); }

 private:
  bool taken_after(std::uint32_t n) const {
    const std::int64_t at = run_->position_after(n).hi();
    return up_ ? at >= step_ : at <= step_;
  }

  void advance() {
    if (step_ == last_) {
      tick_ = none;
      return;
    }
    step_ += up_ ? 1 : -1;
    // Travel from the start of the block to the edge of the step, and its time; floating point
    // gives only an estimate, the exact position decides.
    const Int128 edge = Int128(up_ ? step_ : step_ + 1) << 64;
    const Int128 way = up_ ? edge - run_->position_q64 : run_->position_q64 - edge;
    const double d = static_cast<double>(way.hi()) +
                     static_cast<double>(way.lo()) * (1.0 / 18446744073709551616.0);
    const double root = speed_ * speed_ + 2 * accel_ * d;
    const double guess = 2 * d / (speed_ + std::sqrt(root > 0 ? root : 0));
    std::uint32_t n = guess < ticks_ ? static_cast<std::uint32_t>(guess) + 1 : ticks_;
    while (n < ticks_ && !taken_after(n)) ++n;
    while (n > 1 && taken_after(n - 1)) --n;
    tick_ = n - 1;
  }

  const stepper::AxisRun* run_ = nullptr;
  std::uint32_t ticks_ = 0;
  std::uint32_t tick_ = none;
  bool up_ = true;
  std::int64_t step_ = 0, last_ = 0;
  double speed_ = 0, accel_ = 0;
};

}  // namespace lamplock::sim
