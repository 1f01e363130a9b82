// The outputs of programs: AUX OUT (M62 to M65, M67, M68) and AIR (M7 to M9).
//
// In:  requests of lines, immediate or with the next motion; the board's present tick.
// Out: the level of each pin, except where the state of the machine forbids it
//      (Controller::outputs()). No other code controls these pins.
// Who: the program reader and the controller (main loop); play(): the beat interrupt of the board,
//      at most 100 us after its lattice has reached a tick.
//
// A synchronised change enters the queue only with a line that moves: of several before one line
// the last of each output counts, as in LinuxCNC. The line carries them to the lattice
// (stepper/change_queue.hpp). A digital output has the levels 0 and 65535, an analogue one any
// level: an output is of the kind of its last command.
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
  /// Immediately.
  void set_aux(std::uint16_t level) { aux_ = level; }
  void set_air(bool air) { air_ = air; }
  /// With the next motion.
  void set_next_aux(std::uint16_t level) {
    next_aux_ = level;
    next_waits_ = true;
  }
  bool next_waits() const { return next_waits_; }
  /// The machine is at rest and its next motion is not a line: applies the change now.
  void apply_next() {
    if (next_waits_) set_aux(next_aux_);
    next_waits_ = false;
  }
  /// Drops the change: the line that would carry it is not run.
  void drop_next() { next_waits_ = false; }
  /// A line begins: false while there is no room for its changes. `idle`: every earlier line was
  /// run; changes of those that did not move are still queued, and this one replaces them.
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
  /// Mark for that line (LineTarget::changes).
  std::uint8_t mark() const { return queue_.mark(); }
  /// Everything off, no change queued. Beat and fill masked.
  void all_off() {
    queue_.clear();
    next_waits_ = air_ = false;
    aux_ = 0;
  }

  // Beat interrupt.
  /// The lattice has reached this tick (lower half of its number).
  void play(std::uint32_t tick) {
    while (queue_.waits() && static_cast<std::int32_t>(tick - queue_.front().due_tick) >= 0) {
      aux_ = queue_.front().level;
      queue_.pop();
    }
  }
  bool changes_wait() const { return queue_.waits(); }
  /// Tick of the next change that is known; false if there is none.
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
