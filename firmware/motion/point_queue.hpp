// The queue of targets: those that the host has sent and the laser has not yet fired.
//
// In:  the decoder pushes targets in job order (main loop).
// Out: the planner reads ahead of the machine; a target leaves only when it is done, so that the
//      machine can always return to it after a missed flash, a hold or a lost link. Targets are
//      done in order: a missed one blocks every later shot (shot_scheduler.hpp). One with several
//      flashes is done with the last of them.
// Level: main loop; outcomes of shots arrive through the job runner. No allocation.
#pragma once

#include <array>
#include <cstdint>

#include "shared/wire/target.hpp"

namespace lamplock::motion {

/// Ring of targets addressed by their index in the job.
class PointQueue {
 public:
  static constexpr std::uint32_t capacity = 1024;

  /// Empties the queue; the next target pushed has index `first`.
  void reset(std::uint32_t first) {
    begin_ = end_ = first;
    done_ = 0;
  }
  std::uint32_t begin() const { return begin_; }  ///< index of the first target not done
  std::uint32_t end() const { return end_; }      ///< index after the last target received
  std::uint32_t size() const { return end_ - begin_; }
  std::uint32_t free() const { return capacity - size(); }

  /// Adds a target; false if full.
  bool push(const wire::Target& target) {
    if (free() == 0) return false;
    slots_[end_ % capacity] = target;
    ++end_;
    return true;
  }

  /// Target `index`, begin() <= index < end().
  const wire::Target& at(std::uint32_t index) const { return slots_[index % capacity]; }

  /// Flashes still to come at target `index`; one without shots has one passage instead.
  std::uint32_t left(std::uint32_t index) const {
    const std::uint32_t shots = at(index).shots;
    return (shots == 0 ? 1 : shots) - (index == begin_ ? done_ : 0);
  }

  /// Counts one flash of the first target, which leaves with its last one. No effect for any other
  /// target: it was done before.
  void mark_done(std::uint32_t index) {
    if (index != begin_ || begin_ == end_) return;
    if (left(index) > 1) {
      ++done_;
      return;
    }
    done_ = 0;
    ++begin_;
  }

 private:
  std::array<wire::Target, capacity> slots_{};
  std::uint32_t begin_ = 0;
  std::uint32_t end_ = 0;
  std::uint32_t done_ = 0;  ///< flashes of the first target that have been fired
};

}  // namespace lamplock::motion
