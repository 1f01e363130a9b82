// The ring of segments between planner and tick generator.
//
// One writer (main loop) and one reader (fill interrupt); indices are single words that never
// decrease, so neither side needs a lock. The writer may also take back what the reader has not
// begun, with the fill interrupt masked (a few instructions). It may write segments after the end
// beforehand: the reader does not see them before they are published.
//
//   released | begun, still read | not begun: front() ...
//            kept_               begun()                 end
#pragma once

#include <array>
#include <cstdint>

#include "firmware/stepper/segment.hpp"

namespace lamplock::stepper {

/// Fixed ring of segments.
class SegmentQueue {
 public:
  static constexpr std::uint32_t capacity = 64;

  /// Segments that have not begun.
  std::uint32_t size() const { return end_ - begun_; }
  std::uint32_t free() const { return capacity - (end_ - kept_); }
  bool empty() const { return begun_ == end_; }
  /// The reader has released all segments that have begun.
  bool released() const { return kept_ == begun_; }

  /// The place `ahead` places after the end, to be written; the reader does not see it before
  /// publish().
  Segment& stage(std::uint32_t ahead = 0) { return at(end_ + ahead); }
  /// Appends the segment staged at the end.
  void publish() { end_ = end_ + 1; }
  void push(const Segment& s) {
    stage() = s;
    publish();
  }
  const Segment& front() const { return at(begun_); }
  /// The front begins; it stays until it is released.
  void begin_front() { begun_ = begun_ + 1; }
  /// Index of the front; segments before it have begun.
  std::uint32_t begun() const { return begun_; }
  const Segment& at(std::uint32_t i) const { return slots_[i % capacity]; }
  Segment& at(std::uint32_t i) { return slots_[i % capacity]; }
  /// Segments before this index are no longer read.
  void release(std::uint32_t before) { kept_ = before; }
  /// Removes the last `count` segments; the reader must not have begun them.
  void take_back(std::uint32_t count) { end_ = end_ - count; }
  /// Removes every segment that has not begun.
  void clear() { end_ = begun_; }

 private:
  std::array<Segment, capacity> slots_{};
  std::uint32_t kept_ = 0;
  std::uint32_t begun_ = 0;
  std::uint32_t end_ = 0;
};

}  // namespace lamplock::stepper
