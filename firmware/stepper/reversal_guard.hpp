// The reversal guard: the times that a drive wants around a change of direction.
//
// In:  tick by tick which way an axis goes and whether it steps, as Bresenham has it.
// Out: the same steps, where the direction has just changed some ticks later: DIR changes `hold`
//      ticks behind the last step of the old direction or later, the first step the new way comes
//      `setup` ticks behind that or later. No step is lost or doubled: what has to wait is owed and
//      put out one a tick as soon as it may be; steps of both ways that are owed cancel each other.
// Who: the boards' step output (fill interrupt of the RP2040, the virtual board), one each axis,
//      one definition, so that both step at the same ticks. Budget: some 60 cycles a tick, in the
//      few ticks around a reversal and nowhere else: while passes() is true the board puts steps
//      out as they come, without asking.
//
//   tick      0  1  2  3  4  5  6  7          hold 2, set-up 3
//   wanted    +     -           -             an axis that turns just behind a step
//   DIR       +  +  -  -  -  -  -  -
//   put out   +              -  -
//
// An axis turns slowly, so DIR nearly always changes long before the first step back: it does so
// when the rate changes its sign, not when the step comes. At points an axis stands in the middle
// of a step, so that a guard of some ticks is over, or not begun, when the lattice gets there:
// within `hold + setup` ticks from its turn an axis with acceleration a moves a n^2 / 2, 5e-5 of a
// step in 10 ticks at 5 m/s2 and 200 steps/mm.
//
// The guard is the same in every pulse mode. With CW and CCW it is the time between pulses of both
// wires, in quadrature that for which a level stays.
#pragma once

#include <cstdint>

namespace lamplock::stepper {

/// Times around a change of direction, in whole ticks.
struct DirectionTimes {
  std::uint8_t setup_ticks = 1;  ///< change of DIR to step, at least 1
  std::uint8_t hold_ticks = 1;   ///< step to change of DIR, at least 1
};

/// One axis.
class ReversalGuard {
 public:
  void set_times(const DirectionTimes& times) { times_ = times; }
  /// Starts anew, at rest: DIR stands, nothing is owed.
  void begin(bool back) {
    back_ = heading_back_ = back;
    owed_ = 0;
    since_turn_ = times_.setup_ticks;
    settled_ = true;
  }

  /// Nothing is owed, DIR is where the axis goes and has been so for long enough.
  bool settled() const { return settled_; }
  /// Steps this way may be put out as they come.
  bool passes(bool back) const { return settled_ && back_ == back; }
  /// What DIR says.
  bool back() const { return back_; }
  /// Steps wanted less steps put out.
  std::int32_t owed() const { return owed_; }
  const DirectionTimes& times() const { return times_; }

  /// Before the first tick() after steps that were not asked for: so many ticks before that tick
  /// was the last step (1 = the tick before); anything from hold_ticks on is long ago.
  void wake(std::uint32_t ticks) {
    since_step_ = static_cast<std::uint8_t>(ticks < times_.hold_ticks ? ticks : times_.hold_ticks);
  }
  /// What tick() comes to if hold_ticks are over, and none of the next setup_ticks ticks steps: DIR
  /// changes with the first of them, and the guard is settled again behind the last. Settled
  /// before.
  void turn(bool back) { back_ = heading_back_ = back; }
  /// The axis has a rate from the next tick on, and its sign.
  void head(bool back) { heading_back_ = back; }
  /// The next tick; `wanted` is -1, 0 or 1. True if it steps, the way that back() says.
  bool tick(std::int32_t wanted) {
    owed_ += wanted;
    const bool turn_back = owed_ != 0 ? owed_ < 0 : heading_back_;
    if (turn_back != back_ && since_step_ >= times_.hold_ticks) {
      back_ = turn_back;
      since_turn_ = 0;
    }
    const bool step = owed_ != 0 && turn_back == back_ && since_turn_ >= times_.setup_ticks;
    if (step) {
      owed_ -= back_ ? -1 : 1;
      since_step_ = 0;
    }
    if (since_step_ < times_.hold_ticks) ++since_step_;
    if (since_turn_ < times_.setup_ticks) ++since_turn_;
    settled_ = owed_ == 0 && back_ == heading_back_ && since_turn_ >= times_.setup_ticks;
    return step;
  }

 private:
  std::int32_t owed_ = 0;
  DirectionTimes times_;
  std::uint8_t since_step_ = 0, since_turn_ = 0;  ///< ticks, no further than they matter
  bool back_ = false;                             ///< DIR
  bool heading_back_ = false;                     ///< sign of the rate, the last that was not zero
  bool settled_ = true;
};

}  // namespace lamplock::stepper
