// The queue of targets: what the host has sent and the laser has not yet fired.
//
// In:  the decoder pushes targets in job order (main loop).
// Out: the planner reads ahead of the machine; a target leaves only when it is done, so that a
//      missed flash, a hold or a lost link can always go back to it.
// Level: main loop only; the outcomes of shots reach it through the job runner. No allocation.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/target.hpp"

namespace lamplock::motion {

/// Ring of targets addressed by their index in the job.
class PointQueue {
 public:
  static constexpr std::uint32_t capacity = 1024;

  /// Empties the queue; the next target pushed has index `first`.
  void reset(std::uint32_t first) { begin_ = end_ = first; }
  std::uint32_t begin() const { return begin_; }  ///< index of the first target not done
  std::uint32_t end() const { return end_; }      ///< index after the last target received
  std::uint32_t size() const { return end_ - begin_; }
  std::uint32_t free() const { return capacity - size(); }

  /// Adds a target; false if full.
  bool push(const Target& target) {
    if (free() == 0) return false;
    slots_[end_ % capacity] = {target, false};
    ++end_;
    return true;
  }

  /// Target `index`, begin() <= index < end().
  const Target& at(std::uint32_t index) const { return slots_[index % capacity].target; }
  bool done(std::uint32_t index) const { return slots_[index % capacity].done; }

  /// Marks a target as done and drops every done target at the front.
  void mark_done(std::uint32_t index) {
    slots_[index % capacity].done = true;
    while (begin_ != end_ && slots_[begin_ % capacity].done) ++begin_;
  }

 private:
  struct Slot {
    Target target;
    bool done;
  };
  std::array<Slot, capacity> slots_{};
  std::uint32_t begin_ = 0;
  std::uint32_t end_ = 0;
};

}  // namespace lamplock::motion
