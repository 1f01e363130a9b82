// Lines for the planner, which may be another core.
//
// In:  lines of the program, in order (main loop). Out: the same (the core that plans).
// One writer and one reader; each index has one writer and never decreases, so there is no lock. A
// line is written before the index that publishes it.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/line/ring.hpp"

namespace lamplock::machine {

class LineBuffer {
 public:
  /// The lines of a batch, and those that are read meanwhile.
  static constexpr std::uint32_t capacity = 64;

  // Main loop.
  bool full() const { return end_ - load(begin_) == capacity; }
  std::uint32_t free() const { return capacity - size(); }
  /// There must be room.
  void push(const motion::LineTarget& line) {
    lines_[end_ % capacity] = line;
    store(end_, end_ + 1);
  }

  // The planner.
  const motion::LineTarget& front() const { return lines_[begin_ % capacity]; }
  void pop() { store(begin_, begin_ + 1); }
  void clear() { store(begin_, load(end_)); }

  // Either.
  bool empty() const { return load(begin_) == load(end_); }
  std::uint32_t size() const { return load(end_) - load(begin_); }

 private:
  static void store(std::uint32_t& word, std::uint32_t value) {
    __atomic_store_n(&word, value, __ATOMIC_SEQ_CST);
  }
  static std::uint32_t load(const std::uint32_t& word) {
    return __atomic_load_n(&word, __ATOMIC_SEQ_CST);
  }

  std::array<motion::LineTarget, capacity> lines_{};
  std::uint32_t begin_ = 0;  ///< written by the planner
  std::uint32_t end_ = 0;    ///< written by the main loop
};

}  // namespace lamplock::machine
