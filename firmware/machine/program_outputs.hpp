// The outputs of programs: AUX OUT (M62 to M65, M67, M68) and AIR (M7 to M9).
//
// In:  what lines ask for, at once or with the next motion; the board's present tick.
// Out: the level that each pin is to have, but for what the state of the machine forbids
//      (Controller::outputs()). Nobody else decides about these pins.
// Who: the program reader and the controller (main loop); play() the board, when its lattice has
//      come to a tick (100 us at most behind it: beat interrupt).
//
// Synchronised changes keep no place in the queue until a line begins that moves: of several before
// one line the last of each output counts, as in LinuxCNC. Then they travel with the line
// (stepper/change_queue.hpp). A level is 0 or all for a digital output, anything between for an
// analogue one: an output is whichever it was told last.
#pragma once

#include <cstdint>

#include "firmware/stepper/change_queue.hpp"

namespace lamplock::machine {

class ProgramOutputs {
 public:
  explicit ProgramOutputs(stepper::ChangeQueue& queue) : queue_(queue) {}
  ProgramOutputs(const ProgramOutputs&) = delete;
  ProgramOutputs& operator=(const ProgramOutputs&) = delete;

  // Main loop.
  /// At once.
  void set_aux(std::uint16_t level) { aux_ = level; }
  void set_air(bool air) { air_ = air; }
  /// With the next motion.
  void set_next_aux(std::uint16_t level) {
    next_aux_ = level;
    next_waits_ = true;
  }
  bool next_waits() const { return next_waits_; }
  /// The machine stands and something else than a line moves it next: now.
  void apply_next() {
    if (next_waits_) set_aux(next_aux_);
    next_waits_ = false;
  }
  /// Lines that would have come are not taken.
  void drop_next() { next_waits_ = false; }
  /// A line begins: false while there is no room for what it takes along. `idle`: every line before
  /// was run, and those that moved nothing have left their changes behind, which this one outdates.
  bool attach(bool idle) {
    if (!next_waits_) return true;
    if (queue_.full()) {
      if (!idle) return false;
      queue_.clear();
    }
    queue_.push(next_aux_);
    next_waits_ = false;
    return true;
  }
  /// What that line carries (LineTarget::changes).
  std::uint8_t mark() const { return queue_.mark(); }
  /// Everything off, nothing waits. Beat and fill masked.
  void all_off() {
    queue_.clear();
    next_waits_ = air_ = false;
    aux_ = 0;
  }

  // Beat interrupt.
  /// The lattice has come to this tick (lower half of its number).
  void play(std::uint32_t tick) {
    while (queue_.waits() && static_cast<std::int32_t>(tick - queue_.front().due_tick) >= 0) {
      aux_ = queue_.front().level;
      queue_.pop();
    }
  }
  bool changes_wait() const { return queue_.waits(); }
  /// Of the next change that is known; false if there is none.
  bool next_due(std::uint32_t& tick) const {
    if (!queue_.waits()) return false;
    tick = queue_.front().due_tick;
    return true;
  }

  // Anywhere.
  std::uint16_t aux() const { return aux_; }
  bool air() const { return air_; }

 private:
  stepper::ChangeQueue& queue_;
  volatile std::uint16_t aux_ = 0;
  std::uint16_t next_aux_ = 0;
  bool next_waits_ = false;
  bool air_ = false;
};

}  // namespace lamplock::machine
