// One FIFO of a PIO state machine: 4 words, 8 with the other FIFO's storage, or none (RP2040
// datasheet, 3.2.4 and SMx_SHIFTCTRL FJOIN).
#pragma once

#include <array>
#include <cstdint>

namespace lamplock::sim::chip::pio {

/// Words in order of arrival.
class Fifo {
 public:
  /// Empties it; `depth` is 0, 4 or 8.
  void set_depth(unsigned depth) {
    depth_ = depth;
    level_ = 0;
    head_ = 0;
  }
  unsigned depth() const { return depth_; }
  unsigned level() const { return level_; }
  bool empty() const { return level_ == 0; }
  bool full() const { return level_ >= depth_; }
  /// The caller has made sure that it is not full.
  void push(std::uint32_t word) { words_[(head_ + level_++) % words_.size()] = word; }
  /// The caller has made sure that it is not empty.
  std::uint32_t pop() {
    const std::uint32_t word = words_[head_];
    head_ = (head_ + 1) % static_cast<unsigned>(words_.size());
    --level_;
    return word;
  }
  /// A read of an empty FIFO is undefined; here it returns the word in the place of the next.
  std::uint32_t front() const { return words_[head_]; }

 private:
  std::array<std::uint32_t, 8> words_{};
  unsigned depth_ = 4;
  unsigned level_ = 0;
  unsigned head_ = 0;
};

}  // namespace lamplock::sim::chip::pio
