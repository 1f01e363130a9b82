// Changes of outputs that wait for a tick of the motion (M62, M63, M67).
//
// In:  changes in the order of the program (main loop). The line that begins with them carries a
//      mark, the last of these changes; the segments of the line copy it (Segment::changes).
// Out: each change with the tick at which the lattice enters that line.
// Who: push(), mark(), clear(): main loop, clear() with beat and fill masked. grant(): fill
//      interrupt, ahead of time, when the lattice enters a segment. front(), pop(): beat interrupt
//      of the board, which may interrupt a grant().
//
//   applied_ | granted: their tick is known | granted_ ... wait for their line ... | end_
//
// A mark is a place in this queue, not a number of changes. So every segment of a line may carry
// it, lines that are planned twice or never reached do no harm, and a mark from before clear()
// refers to nothing.
#pragma once

#include <array>
#include <cstdint>

namespace lamplock::stepper {

struct OutputChange {
  std::uint32_t due_tick = 0;  ///< lower half of its number
  std::uint16_t level = 0;     ///< 65535 = on
};

class ChangeQueue {
 public:
  static constexpr std::uint32_t capacity = 16;

  // Main loop.
  bool full() const { return load(end_) - load(applied_) == capacity; }
  bool empty() const { return load(applied_) == load(end_); }
  /// There must be room.
  void push(std::uint16_t level) {
    changes_[load(end_) % capacity].level = level;
    store(end_, load(end_) + 1);
  }
  /// For the line that begins after what was pushed; 0 = no change waits for a line.
  std::uint8_t mark() const {
    const std::uint32_t end = load(end_);
    return load(granted_) == end ? std::uint8_t{0} : static_cast<std::uint8_t>(is_mark | end);
  }
  /// Drops them all.
  void clear() {
    store(granted_, load(end_));
    store(applied_, load(end_));
  }

  // Fill interrupt.
  /// The changes up to this mark are due at `tick`.
  void grant(std::uint8_t mark, std::uint64_t tick) {
    const std::uint32_t granted = load(granted_), count = (mark - granted) & places;
    if (mark == 0 || count > load(end_) - granted) return;
    for (std::uint32_t i = 0; i < count; ++i)
      changes_[(granted + i) % capacity].due_tick = static_cast<std::uint32_t>(tick);
    store(granted_, granted + count);
  }

  // Beat interrupt.
  /// The tick of at least one change is known.
  bool waits() const { return load(applied_) != load(granted_); }
  /// The next one, if waits().
  const OutputChange& front() const { return changes_[load(applied_) % capacity]; }
  void pop() { store(applied_, load(applied_) + 1); }

 private:
  static constexpr std::uint32_t is_mark = 0x80, places = is_mark - 1;
  static_assert(2 * capacity <= places);

  static void store(std::uint32_t& word, std::uint32_t value) {
    __atomic_store_n(&word, value, __ATOMIC_SEQ_CST);
  }
  static std::uint32_t load(const std::uint32_t& word) {
    return __atomic_load_n(&word, __ATOMIC_SEQ_CST);
  }

  std::array<OutputChange, capacity> changes_{};
  std::uint32_t end_ = 0;      ///< written by the main loop
  std::uint32_t granted_ = 0;  ///< written by the fill interrupt
  std::uint32_t applied_ = 0;  ///< written by the beat interrupt
};

}  // namespace lamplock::stepper
