// The reversal guard: the times that a drive needs around a change of direction.
//
// In:  for every tick the direction of an axis and whether it steps, from Bresenham.
// Out: the same steps, some of them a few ticks later after a reversal: DIR changes at least `hold`
//      ticks after the last step of the old direction, and the first step of the new one follows at
//      least `setup` ticks later. No step is lost or doubled: steps that wait are owed and are put
//      out as soon as they may, at least `period` ticks apart; owed steps of opposite directions
//      cancel each other.
// Who: the step outputs of the boards (fill interrupt of the RP2040, the virtual board), one guard
//      per axis; with one definition both boards step at the same ticks. Budget: some 60 cycles a
//      tick, only in the few ticks around a reversal: while passes() is true the board puts steps
//      out without calling tick().
//
//   tick      0  1  2  3  4  5  6  7          hold 2, set-up 3
//   wanted    +     -           -             an axis that reverses just after a step
//   DIR       +  +  -  -  -  -  -  -
//   put out   +              -  -
//
// An axis reverses slowly, so DIR nearly always changes long before the first step back: it changes
// with the sign of the rate, not with the step. At points an axis rests in the middle of a step, so
// that a guard of some ticks is over, or has not begun, when the lattice gets there: within `hold +
// setup` ticks from its turn an axis with acceleration a moves a n^2 / 2, 5e-5 of a step in 10
// ticks at 5 m/s2 and 200 steps/mm.
//
// The guard is the same in every pulse mode. With CW and CCW it is the time between pulses of the
// two wires, in quadrature the time for which a level is constant.
#pragma once

#include <cstdint>

namespace lamplock::stepper {

/// Times around a change of direction, in whole ticks.
struct DirectionTimes {
  std::uint8_t setup_ticks = 1;   ///< change of DIR to step, at least 1
  std::uint8_t hold_ticks = 1;    ///< step to change of DIR, at least 1
  std::uint8_t period_ticks = 1;  ///< step to step, at most the sum of the other two

  /// No time counts longer than this after a step.
  std::uint8_t after_step_ticks() const {
    return hold_ticks > period_ticks ? hold_ticks : period_ticks;
  }
  friend bool operator==(const DirectionTimes&, const DirectionTimes&) = default;
};

/// One axis.
class ReversalGuard {
 public:
  /// Settled only: at the start, or at rest.
  void set_times(const DirectionTimes& times) {
    times_ = times;
    since_turn_ = times.setup_ticks;
  }
  /// Starts again at rest: DIR is constant, no step is owed.
  void begin(bool back) {
    back_ = heading_back_ = back;
    owed_ = 0;
    since_turn_ = times_.setup_ticks;
    settled_ = true;
  }

  /// No step is owed, DIR has been the direction of the axis for long enough, and the next tick may
  /// step.
  bool settled() const { return settled_; }
  /// Steps in this direction may be put out without tick().
  bool passes(bool back) const { return settled_ && back_ == back; }
  /// Level of DIR.
  bool back() const { return back_; }
  /// Steps wanted less steps put out.
  std::int32_t owed() const { return owed_; }
  const DirectionTimes& times() const { return times_; }

  /// To be called before the first tick() after steps that bypassed it. The last step was `ticks`
  /// before that tick (1 = the tick before); values from after_step_ticks() on have no further
  /// effect.
  void wake(std::uint32_t ticks) {
    const std::uint8_t most = times_.after_step_ticks();
    since_step_ = static_cast<std::uint8_t>(ticks < most ? ticks : most);
  }
  /// The effect of tick() if hold_ticks are over and none of the next setup_ticks ticks steps: DIR
  /// changes with the first of them, and the guard is settled again after the last. It must be
  /// settled before.
  void turn(bool back) { back_ = heading_back_ = back; }
  /// The sign of the axis's rate from the next tick on.
  void head(bool back) { heading_back_ = back; }
  /// The next tick; `wanted` is -1, 0 or 1. True if it steps, in the direction of back().
  bool tick(std::int32_t wanted) {
    owed_ += wanted;
    const bool turn_back = owed_ != 0 ? owed_ < 0 : heading_back_;
    if (turn_back != back_ && since_step_ >= times_.hold_ticks) {
      back_ = turn_back;
      since_turn_ = 0;
    }
    const bool step = owed_ != 0 && turn_back == back_ && since_turn_ >= times_.setup_ticks &&
                      since_step_ >= times_.period_ticks;
    if (step) {
      owed_ -= back_ ? -1 : 1;
      since_step_ = 0;
    }
    if (since_step_ < times_.after_step_ticks()) ++since_step_;
    if (since_turn_ < times_.setup_ticks) ++since_turn_;
    settled_ = owed_ == 0 && back_ == heading_back_ && since_turn_ >= times_.setup_ticks &&
               since_step_ >= times_.period_ticks;
    return step;
  }

 private:
  std::int32_t owed_ = 0;
  DirectionTimes times_;
  std::uint8_t since_step_ = 0, since_turn_ = 0;  ///< ticks, limited to what is needed
  bool back_ = false;                             ///< DIR
  bool heading_back_ = false;                     ///< sign of the rate, the last that was not zero
  bool settled_ = true;
};

}  // namespace lamplock::stepper
