// The ring of segments between planner and tick generator.
//
// One writer (main loop) and one reader (fill interrupt); indices are single words and only ever
// grow, so neither side needs a lock. But the writer may take back what the reader has not begun;
// it must do so with the fill interrupt masked (a few instructions).
#pragma once

#include <array>
#include <cstdint>

#include "firmware/stepper/segment.hpp"

namespace lamplock::stepper {

/// Fixed ring of segments.
class SegmentQueue {
 public:
  static constexpr std::uint32_t capacity = 64;

  std::uint32_t size() const { return end_ - begin_; }
  std::uint32_t free() const { return capacity - size(); }
  bool empty() const { return begin_ == end_; }

  void push(const Segment& s) { slots_[end_ % capacity] = s, end_ = end_ + 1; }
  const Segment& front() const { return slots_[begin_ % capacity]; }
  void pop() { begin_ = begin_ + 1; }
  /// Takes back the last `count` segments, all of which the reader has not begun.
  void take_back(std::uint32_t count) { end_ = end_ - count; }
  /// Takes back every segment.
  void clear() { end_ = begin_; }

 private:
  std::array<Segment, capacity> slots_{};
  std::uint32_t begin_ = 0;
  std::uint32_t end_ = 0;
};

}  // namespace lamplock::stepper
